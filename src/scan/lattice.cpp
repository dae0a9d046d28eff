#include "rodwake/scan/lattice.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>

namespace rodwake::scan {

namespace {

/// Numbers of edges, axes() times as many as places, stay below 2^62.
constexpr double most_places = 0x1p60;

double places(const std::vector<Axis>& axes, int depth) {
    double count = 1.0;
    for (const Axis& axis : axes)
        count *= static_cast<double>(axis.count) * static_cast<double>(1LL << depth) + 1.0;
    return count;
}

} // namespace

Lattice::Lattice(const Design& design) : axes_(design.axes) {
    if (axes_.empty() || axes_.size() > max_axes)
        throw InputError("an adaptive scan has one, two or three axes");
    while (axes_.front().count << levels_ < design.resolution)
        ++levels_;
    for (const Axis& axis : axes_)
        if (axis.count << levels_ != design.resolution)
            throw InputError("scan.resolution: must be the count of every axis times one power of two");
    while (depth_ < 40 && places(axes_, depth_ + 1) < most_places)
        ++depth_;
    if (levels_ > depth_)
        throw InputError("scan.resolution: finer than an adaptive scan of so many axes can be");
    for (std::size_t k = 0; k < axes_.size(); ++k)
        steps_[k] = static_cast<std::int64_t>(axes_[k].count) << depth_;
}

std::int64_t Lattice::id(const LatticePoint& position) const {
    std::int64_t id = 0;
    for (std::size_t k = 0; k < axes_.size(); ++k)
        id = id * (steps_[k] + 1) + position[k];
    return id;
}

Lattice::LatticePoint Lattice::place(std::int64_t id) const {
    LatticePoint place{};
    for (std::size_t k = axes_.size(); k-- > 0;) {
        place[k] = id % (steps_[k] + 1);
        id /= steps_[k] + 1;
    }
    return place;
}

Point Lattice::point(const LatticePoint& position) const {
    Point point{id(position), {}};
    for (std::size_t k = 0; k < axes_.size(); ++k)
        point.at[k] = axes_[k].at(fraction(k, position[k]));
    return point;
}

Point Lattice::point_on(const LatticePoint& position, std::size_t axis, double u) const {
    Point moved = point(position);
    moved.at[axis] = axes_[axis].at(u);
    return moved;
}

} // namespace rodwake::scan
