#include "rodwake/measure/state_io.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::measure {

void StateWriter::put(std::span<const double> values) {
    put(values.size());
    values_.insert(values_.end(), values.begin(), values.end());
}

std::span<const double> StateReader::take(std::size_t length) {
    if (length > values_.size() - at_)
        throw RunError(
            fmt::format("{}: {} numbers missing at its end", what_, length - (values_.size() - at_)));
    const auto part = values_.subspan(at_, length);
    at_ += length;
    return part;
}

double StateReader::get() { return take(1)[0]; }

std::size_t StateReader::count() {
    const double value = get();
    if (!(value >= 0.0 && value < 0x1p53 && value == std::floor(value)))
        throw RunError(fmt::format("{}: {} where a count is expected", what_, value));
    return static_cast<std::size_t>(value);
}

std::vector<double> StateReader::array() {
    const auto part = take(count());
    return {part.begin(), part.end()};
}

std::vector<double> StateReader::array(std::size_t length) {
    std::vector<double> values = array();
    if (values.size() != length)
        throw RunError(fmt::format("{}: {} values where {} are expected", what_, values.size(), length));
    return values;
}

void StateReader::finish() const {
    if (at_ != values_.size())
        throw RunError(fmt::format("{}: {} numbers too many", what_, values_.size() - at_));
}

} // namespace rodwake::measure
