#pragma once
// The state of an accumulator as a row of doubles and back, without loss: what checkpoints and measure.rwc
// hold. Counts stay exact below 2^53.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rodwake::measure {

class StateWriter {
public:
    void put(double value) { values_.push_back(value); }
    void put(std::size_t value) { values_.push_back(static_cast<double>(value)); }
    /// Its length, then its values.
    void put(std::span<const double> values);
    std::vector<double> take() { return std::move(values_); }

private:
    std::vector<double> values_;
};

/// Throws RunError ("<what>: ...") where the row ends early, a length or count is none, or something is left
/// at finish(): the numbers belong to something else.
class StateReader {
public:
    StateReader(std::span<const double> values, std::string what) : values_(values), what_(std::move(what)) {}

    double get();
    std::size_t count();
    std::vector<double> array();
    /// An array of exactly this length.
    std::vector<double> array(std::size_t length);
    void finish() const;

private:
    std::span<const double> take(std::size_t length);

    std::span<const double> values_;
    std::size_t at_ = 0;
    std::string what_;
};

} // namespace rodwake::measure
