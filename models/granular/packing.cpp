#include "packing.hpp"

#include "neighbours.hpp"
#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

constexpr double aim = 2e-4; // wanted free distance, of two radii: converges to `separation` in finite time
constexpr double skin_share = 0.6; // of a radius
constexpr double push = 0.55;      // share of the overlap that each of two beads gives way
constexpr double kick = 0.1;       // of a radius, when shaken
constexpr int sweeps_a_round = 2500, rounds = 4;

class PushApart {
public:
    PushApart(Places& places, const Room& room)
        : p_(places), room_(room), skin_(skin_share * room.radius), diameter_(2.0 * room.radius) {}

    /// Largest overlap left.
    double settle(int sweeps) {
        double left = refresh();
        for (int k = 0; k < sweeps && left > 0.0; ++k) {
            left = sweep();
            if (furthest_move() > 0.5 * skin_)
                left = refresh(); // pairs that are not listed may have met
            else if (left == 0.0)
                left = largest_overlap(); // later pairs may have pushed earlier ones
        }
        return refresh();
    }

    void shake(RandomStream& random) {
        for (std::size_t i = 0; i < p_.size(); ++i) {
            const double angle = random.uniform(0.0, 2.0 * M_PI),
                         step = kick * room_.radius * random.uniform();
            p_.x[i] += step * std::cos(angle);
            p_.y[i] += step * std::sin(angle);
            lift(i, kick * room_.radius * random.uniform(-1.0, 1.0));
        }
    }

private:
    struct Gap {
        double x, y, z, distance;
    };

    Gap gap(Near pair) const {
        const double x = nearest_image_rounded(p_.x[pair.bead] - p_.x[pair.other], room_.box);
        const double y = nearest_image_rounded(p_.y[pair.bead] - p_.y[pair.other], room_.box);
        const double z = p_.z[pair.bead] - p_.z[pair.other];
        return {x, y, z, std::sqrt(x * x + y * y + z * z)};
    }
    Gap gap_to_rod(Near pair) const {
        const Disc& disc = room_.rods[pair.other];
        const double x = nearest_image_rounded(p_.x[pair.bead] - disc.x, room_.box);
        const double y = nearest_image_rounded(p_.y[pair.bead] - disc.y, room_.box);
        const double z = p_.z[pair.bead] - disc.height;
        return {x, y, z, std::sqrt(x * x + y * y + z * z)};
    }
    double touching(Near pair) const { return room_.rods[pair.other].radius + room_.radius; }

    void lift(std::size_t i, double step) {
        p_.z[i] = std::clamp(p_.z[i] + step, -room_.height, room_.height);
    }

    /// New pairs; the largest overlap.
    double refresh() {
        near_ = neighbours(p_, room_, skin_);
        x_ = p_.x;
        y_ = p_.y;
        return largest_overlap();
    }

    /// In plan view since the pairs were found.
    double furthest_move() const {
        double square = 0.0;
        for (std::size_t i = 0; i < x_.size(); ++i) {
            const double x = p_.x[i] - x_[i], y = p_.y[i] - y_[i];
            square = std::max(square, x * x + y * y);
        }
        return std::sqrt(square);
    }

    double largest_overlap() const {
        double largest = 0.0;
        for (const Near pair : near_.beads)
            largest = std::max(largest, diameter_ * (1.0 + separation) - gap(pair).distance);
        for (const Near pair : near_.rods)
            largest = std::max(largest, touching(pair) * (1.0 + separation) - gap_to_rod(pair).distance);
        return largest;
    }

    /// Every pair once; the largest overlap met on the way.
    double sweep() {
        double largest = 0.0;
        for (const Near pair : near_.beads)
            largest = std::max(largest, part(pair));
        for (const Near pair : near_.rods)
            largest = std::max(largest, part_from_rod(pair));
        return largest;
    }

    double part(Near pair) {
        const Gap g = gap(pair);
        const double missing = diameter_ * (1.0 + aim) - g.distance;
        if (missing <= 0.0)
            return 0.0;
        if (g.distance > 0.0) {
            const double share = push * missing / g.distance;
            move(pair.bead, share * g.x, share * g.y, share * g.z);
            move(pair.other, -share * g.x, -share * g.y, -share * g.z);
        } else { // the same place: any direction will do
            move(pair.bead, push * missing, 0.0, 0.0);
        }
        return std::max(0.0, diameter_ * (1.0 + separation) - g.distance);
    }

    /// In the plane only: a bead cannot leave a rod upwards.
    double part_from_rod(Near pair) {
        const Gap g = gap_to_rod(pair);
        const double wanted = touching(pair) * (1.0 + aim);
        if (g.distance >= wanted)
            return 0.0;
        const double in_plane = std::hypot(g.x, g.y),
                     missing = std::sqrt(wanted * wanted - g.z * g.z) - in_plane;
        if (in_plane > 0.0)
            move(pair.bead, missing * g.x / in_plane, missing * g.y / in_plane, 0.0);
        else
            move(pair.bead, missing, 0.0, 0.0);
        return std::max(0.0, touching(pair) * (1.0 + separation) - g.distance);
    }

    void move(std::uint32_t i, double x, double y, double z) {
        p_.x[i] += x;
        p_.y[i] += y;
        lift(i, z);
    }

    Places& p_;
    const Room& room_;
    double skin_, diameter_;
    Neighbours near_;
    std::vector<double> x_, y_; // when the pairs were found
};

} // namespace

double push_apart(Places& places, const Room& room, RandomStream random) {
    PushApart work(places, room);
    double left = work.settle(sweeps_a_round);
    for (int round = 1; round < rounds && left > 0.0; ++round) {
        work.shake(random);
        left = work.settle(sweeps_a_round);
    }
    return left;
}

} // namespace rodwake::granular
