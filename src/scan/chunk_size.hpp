#pragma once

#include <algorithm>
#include <cstddef>

namespace rodwake::scan {

/// How many points to hand out at once: about 10 ms of work by what a point has cost so far, and at the end
/// not so many that others wait.
class ChunkSize {
public:
    explicit ChunkSize(std::size_t workers) : workers_(std::max<std::size_t>(workers, 1)) {}

    void learn(std::size_t points, double seconds) {
        points_ += static_cast<double>(points);
        seconds_ += seconds;
    }

    std::size_t next(std::size_t left) const {
        if (points_ == 0.0) // not known yet
            return std::min<std::size_t>(left, 1);
        const double a_second = points_ / std::max(seconds_, 1e-9);
        const double share = static_cast<double>(left) / (2.0 * static_cast<double>(workers_));
        const double wanted = std::clamp(share, std::min(least * a_second, enough), target * a_second);
        return std::clamp<std::size_t>(static_cast<std::size_t>(std::min(wanted, 1e9)), 1,
                                       std::min<std::size_t>(left, most));
    }

private:
    static constexpr double target = 0.01; // s
    static constexpr double least = 2e-4;  // s: less does not repay handing it out,
    static constexpr double enough = 16.0; // but so many points fill the lanes of pairs
    static constexpr std::size_t most = 4096;
    std::size_t workers_;
    double points_ = 0.0, seconds_ = 0.0;
};

} // namespace rodwake::scan
