#pragma once
// Judging a series of errors at falling tolerances.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace rodwake::integrate::test {

struct Ladder {
    std::vector<double> rtol, error;
};

/// error(rtol) for rtol = 10^-first to 10^-last.
template<class Error>
Ladder climb(int first, int last, Error error) {
    Ladder ladder;
    for (int decade = first; decade <= last; ++decade) {
        ladder.rtol.push_back(std::pow(10.0, -decade));
        ladder.error.push_back(error(ladder.rtol.back()));
    }
    return ladder;
}

/// Least-squares slope of log error against log rtol.
inline double slope(const Ladder& ladder) {
    double x = 0, y = 0, xx = 0, xy = 0;
    const double n = static_cast<double>(ladder.rtol.size());
    for (std::size_t i = 0; i < ladder.rtol.size(); ++i) {
        const double a = std::log(ladder.rtol[i]), b = std::log(ladder.error[i]);
        x += a, y += b, xx += a * a, xy += a * b;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

/// Each decade lowers the error, or at least each pair of decades does where a change of order made one no
/// better.
inline bool falls(const Ladder& ladder) {
    for (std::size_t i = 1; i < ladder.error.size(); ++i) {
        if (ladder.error[i] > 2.0 * ladder.error[i - 1])
            return false;
        if (i > 1 && ladder.error[i] >= ladder.error[i - 2])
            return false;
    }
    return true;
}

inline std::string describe(const Ladder& ladder) {
    std::string text;
    for (std::size_t i = 0; i < ladder.rtol.size(); ++i)
        text += std::to_string(std::log10(ladder.rtol[i])) + " " +
                std::to_string(std::log10(ladder.error[i])) + "; ";
    return text;
}

} // namespace rodwake::integrate::test
