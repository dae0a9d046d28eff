#include "rodwake/scan/design.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"

#include <boost/random/sobol.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::scan {

void Result::set_cause(std::string_view text) {
    const std::size_t length = std::min(text.size(), cause.size() - 1);
    std::ranges::copy(text.substr(0, length), cause.begin());
    cause[length] = '\0';
}

std::string cause_pattern(std::string_view text) {
    std::string pattern;
    const auto digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t first = i + (text[i] == '-' ? 1 : 0);
        if (!digit(first)) {
            pattern += text[i++];
            continue;
        }
        for (i = first;
             digit(i) || (text[i - 1] != '.' && i < text.size() && text[i] == '.' && digit(i + 1));)
            ++i;
        if (i < text.size() && text[i] == 'e' && (digit(i + 1) || digit(i + 2)))
            for (i += 2; digit(i);)
                ++i;
        pattern += '#';
    }
    return pattern;
}

double Axis::at(double u) const {
    if (spacing == Spacing::listed) {
        const double last = static_cast<double>(values.size()) - 1.0;
        return values[static_cast<std::size_t>(std::lround(std::clamp(u, 0.0, 1.0) * last))];
    }
    if (u <= 0.0 || u >= 1.0)
        return u <= 0.0 ? from : to;
    double value = std::lerp(from, to, u);
    if (spacing == Spacing::log) {
        const double sign = from < 0.0 ? -1.0 : 1.0;
        const double low = std::log(std::abs(from)), high = std::log(std::abs(to));
        const auto [least, most] = std::minmax(from, to); // rounding must not leave the axis
        value = std::clamp(sign * std::exp(low + (high - low) * u), least, most);
    }
    return whole ? std::round(value) : value;
}

const char* to_string(Kind kind) {
    static constexpr const char* names[] = {"grid", "list", "lhs", "sobol", "adaptive"};
    return names[static_cast<std::size_t>(kind)];
}

std::int64_t places(const Design& design) {
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

std::int64_t size(const Design& design) {
    const std::int64_t count = places(design);
    if (design.runs == 0)
        return count;
    if (count > std::int64_t{1} << (62 - run_bits))
        throw InputError("the scan has more than 2^62 points");
    return count * design.runs;
}

PointList::PointList(const Design& design) : design_(design), size_(scan::size(design)) {
    const std::size_t axes = design.axes.size(), count = static_cast<std::size_t>(places(design));
    if (design.kind == Kind::lhs) {
        // One point in each of `count` slices of every axis, the slices in random order.
        fractions_.resize(count * axes);
        std::vector<std::size_t> slice(count);
        for (std::size_t axis = 0; axis < axes; ++axis) {
            RandomStream random(design.seed, static_cast<std::uint32_t>(axis));
            std::iota(slice.begin(), slice.end(), std::size_t{0});
            for (std::size_t i = count; i > 1; --i) // Fisher and Yates
                std::swap(slice[i - 1],
                          slice[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
            for (std::size_t i = 0; i < count; ++i)
                fractions_[i * axes + axis] =
                    (static_cast<double>(slice[i]) + random.uniform()) / static_cast<double>(count);
        }
    }
    if (design.kind == Kind::sobol) {
        // Sobol' points in base 2 (direction numbers of Joe and Kuo, from Boost, which leaves out the
        // corner).
        boost::random::sobol sequence(axes);
        const double unit = 1.0 / (static_cast<double>(boost::random::sobol::max()) + 1.0);
        fractions_.resize(count * axes);
        for (double& fraction : fractions_)
            fraction = static_cast<double>(sequence()) * unit;
    }
    if (design.costs.empty())
        return;
    order_.resize(count);
    rank_.resize(count);
    std::iota(order_.begin(), order_.end(), std::int64_t{0});
    std::ranges::stable_sort(order_, std::ranges::greater(), [&](std::int64_t index) {
        return design.costs[static_cast<std::size_t>(index)];
    });
    for (std::size_t i = 0; i < count; ++i)
        rank_[static_cast<std::size_t>(order_[i])] = static_cast<std::int64_t>(i);
}

Point PointList::operator[](std::int64_t number) const {
    const std::int64_t runs = std::max(design_.runs, 1L), turn = number / runs;
    const std::int64_t index = order_.empty() ? turn : order_[static_cast<std::size_t>(turn)];
    Point point = at_place(index);
    if (design_.runs > 0)
        point.id = id_of_run(index, number % runs);
    return point;
}

std::optional<std::int64_t> PointList::number_of(std::int64_t id) const {
    const bool repeated = design_.runs > 0;
    const std::int64_t runs = std::max(design_.runs, 1L), place = repeated ? place_of_run(id) : id,
                       run = repeated ? run_of(id) : 0;
    if (id < 0 || place >= size_ / runs || run >= runs)
        return std::nullopt;
    return (rank_.empty() ? place : rank_[static_cast<std::size_t>(place)]) * runs + run;
}

Point PointList::at_place(std::int64_t index) const {
    Point point{index, {}};
    const std::size_t axes = design_.axes.size(), row = static_cast<std::size_t>(index);
    if (design_.kind == Kind::list) {
        if (is_long_list(design_))
            point.at[0] = static_cast<double>(row);
        else
            std::ranges::copy(design_.rows[row], point.at.begin());
        return point;
    }
    std::int64_t rest = index;
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
