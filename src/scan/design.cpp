#include "rodwake/scan/design.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"

#include <boost/random/sobol.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::scan {

namespace {

/// Sobol' points in base 2 (direction numbers of Joe and Kuo, from Boost, which leaves out the corner).
std::vector<double> sobol_fractions(std::size_t points, std::size_t axes) {
    boost::random::sobol sequence(axes);
    const double unit = 1.0 / (static_cast<double>(boost::random::sobol::max()) + 1.0);
    std::vector<double> fractions(points * axes);
    for (double& fraction : fractions)
        fraction = static_cast<double>(sequence()) * unit;
    return fractions;
}

/// One point in each of `points` slices of every axis, the slices in random order.
std::vector<double> lhs_fractions(std::size_t points, std::size_t axes, std::uint64_t seed) {
    std::vector<double> fractions(points * axes);
    std::vector<std::size_t> slice(points);
    for (std::size_t axis = 0; axis < axes; ++axis) {
        RandomStream random(seed, static_cast<std::uint32_t>(axis));
        std::iota(slice.begin(), slice.end(), std::size_t{0});
        for (std::size_t i = points; i > 1; --i) // Fisher and Yates
            std::swap(slice[i - 1],
                      slice[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
        for (std::size_t i = 0; i < points; ++i)
            fractions[i * axes + axis] =
                (static_cast<double>(slice[i]) + random.uniform()) / static_cast<double>(points);
    }
    return fractions;
}

double log_at(const Axis& axis, double u) {
    const double sign = axis.from < 0.0 ? -1.0 : 1.0;
    const double low = std::log(std::abs(axis.from)), high = std::log(std::abs(axis.to));
    const auto [least, most] = std::minmax(axis.from, axis.to); // rounding must not leave the axis
    return std::clamp(sign * std::exp(low + (high - low) * u), least, most);
}

} // namespace

void Result::set_cause(std::string_view text) {
    const std::size_t length = std::min(text.size(), cause.size() - 1);
    std::ranges::copy(text.substr(0, length), cause.begin());
    cause[length] = '\0';
}

double Axis::at(double u) const {
    if (spacing == Spacing::listed) {
        const double last = static_cast<double>(values.size()) - 1.0;
        return values[static_cast<std::size_t>(std::lround(std::clamp(u, 0.0, 1.0) * last))];
    }
    if (u <= 0.0 || u >= 1.0)
        return u <= 0.0 ? from : to;
    const double value = spacing == Spacing::log ? log_at(*this, u) : std::lerp(from, to, u);
    return whole ? std::round(value) : value;
}

const char* to_string(Kind kind) {
    static constexpr const char* names[] = {"grid", "list", "lhs", "sobol", "adaptive"};
    return names[static_cast<std::size_t>(kind)];
}

std::int64_t size(const Design& design) {
    if (design.kind == Kind::list)
        return static_cast<std::int64_t>(design.rows.size());
    if (design.kind == Kind::lhs || design.kind == Kind::sobol)
        return design.samples;
    double count = 1.0;
    std::int64_t points = 1;
    for (const Axis& axis : design.axes) {
        const long side = design.kind == Kind::adaptive ? design.resolution + 1 : axis.count;
        count *= static_cast<double>(side);
        if (count > 0x1p62)
            throw InputError("the scan has more than 2^62 points");
        points *= side;
    }
    return points;
}

PointList::PointList(const Design& design) : design_(design), size_(scan::size(design)) {
    const std::size_t axes = design.axes.size();
    if (design.kind == Kind::lhs)
        fractions_ = lhs_fractions(static_cast<std::size_t>(size_), axes, design.seed);
    if (design.kind == Kind::sobol)
        fractions_ = sobol_fractions(static_cast<std::size_t>(size_), axes);
}

Point PointList::operator[](std::int64_t id) const {
    Point point{id, {}};
    const std::size_t axes = design_.axes.size(), row = static_cast<std::size_t>(id);
    if (design_.kind == Kind::list) {
        std::ranges::copy(design_.rows[row], point.at.begin());
        return point;
    }
    std::int64_t rest = id;
    for (std::size_t k = axes; k-- > 0;) { // the last axis runs fastest
        const Axis& axis = design_.axes[k];
        if (design_.kind == Kind::grid) {
            const double last = static_cast<double>(std::max(axis.count - 1, 1L));
            point.at[k] = axis.at(static_cast<double>(rest % axis.count) / last);
            rest /= axis.count;
        } else
            point.at[k] = axis.at(fractions_[row * axes + k]);
    }
    return point;
}

} // namespace rodwake::scan
