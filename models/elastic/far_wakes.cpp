#include "far_wakes.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

using fourier::NonuniformFft, fourier::SpreadKernel;

namespace {

/// What one wake may be wrong by, in xi: a tenth of a sum's error, since few are at the reach, or where a
/// mesh is worst, and signs differ. Far wakes as a whole are not small beside it.
double error_of_one(double tolerance) { return std::clamp(0.1 * tolerance, 1e-13, 1e-4); }

constexpr std::size_t most_first = 48; ///< first nodes that are thought of

struct Extent {
    double x, y, width, height;

    double side() const { return std::max(width, height); }
};

Extent extent_of(std::span<const KernelSource> rods) {
    const auto [left, right] = std::ranges::minmax(rods, {}, &KernelSource::x);
    const auto [low, high] = std::ranges::minmax(rods, {}, &KernelSource::y);
    return {left.x, low.y, right.x - left.x, high.y - low.y};
}

double square(double x) { return x * x; }

/// Targets by distance from a source at the origin that heads along x, and what they are given.
struct Sample {
    static constexpr std::size_t directions = 24, distances = 100; // in vectors of 8
    std::vector<double> x, y;
    std::array<std::vector<double>, all_parts> part;

    static double distance(std::size_t k) { return std::pow(1.06, static_cast<double>(k)); }

    Sample() {
        for (std::size_t k = 0; k < distances; ++k)
            for (std::size_t i = 0; i < directions; ++i) {
                const double beside = (static_cast<double>(i) + 0.01) / directions,
                             angle = std::numbers::pi * (1.0 - beside * beside); // denser behind the rod
                x.push_back(distance(k) * std::cos(angle));
                y.push_back(distance(k) * std::sin(angle));
            }
        for (auto& one : part)
            one.resize(x.size());
    }

    KernelTargets targets(bool polar, std::size_t from, std::size_t count) {
        KernelTargets t{x.data() + from, y.data() + from, count, {}};
        for (int k = 0; k < (polar ? all_parts : strain_parts); ++k)
            t.sum[k] = part[k].data() + from;
        return t;
    }

    double largest(std::size_t distance, int begin, int end) const {
        double most = 0.0;
        for (std::size_t i = distance * directions; i < (distance + 1) * directions; ++i)
            for (int k = begin; k < end; ++k)
                most = std::max(most, std::abs(part[k][i]));
        return most;
    }
};

constexpr std::size_t largest_half = 2500; ///< modes of a mesh in each direction: some 2 GB
constexpr double largest_crowd = 1e5;      ///< beyond it meshes never pay

constexpr double bend = 10.0; ///< node at which steps have widened

} // namespace

FarWakes::FarWakes(const Medium& medium, double strain_tolerance, double polar_tolerance, bool polar)
    : unit_({medium.eta, 1.0}), polar_(polar), strain_error_(error_of_one(strain_tolerance * medium.xi)),
      polar_error_(error_of_one(polar_tolerance * square(medium.xi))),
      cutoff_(-std::log(polar ? std::min(strain_error_, polar_error_) : strain_error_)) {
    width_ = std::min(static_cast<std::size_t>(std::ceil(cutoff_ / 1.8)) + 1, SpreadKernel::widest);
    for (const auto& [step, wider] : {std::pair{1.2, 0.0}, {1.0, 0.8}, {1.0, 1.6}}) {
        nodes_.push_back({step / std::sqrt(cutoff_), wider, medium.eta, cutoff_, {}});
        find_reaches(nodes_.back());
    }
}

double FarWakes::Nodes::width_at(double time) const { return 2.0 * std::sqrt((1.0 + eta) * time * cutoff); }

double FarWakes::Nodes::root_time(std::size_t k) const {
    const auto at = static_cast<double>(k);
    return step * (at + wider * (std::sqrt(at * at + bend * bend) - bend));
}

HeatNode FarWakes::Nodes::at(std::size_t k) const {
    const auto number = static_cast<double>(k);
    return heat_node(root_time(k), step * (1.0 + wider * number / std::sqrt(number * number + bend * bend)),
                     eta);
}

/// The node from which on all Gaussians have left a place for one `distance` behind it.
std::size_t FarWakes::Nodes::last_for(double distance) const {
    const double root = std::sqrt((1.0 + eta) * cutoff), // t - 2 root sqrt(t) = distance
        end = root + std::sqrt(square(root) + distance);
    const double q = end / step + wider * bend, cc = wider * wider; // of root_time(k) = end
    return static_cast<std::size_t>((q - wider * std::sqrt(q * q + bend * bend * (1.0 - cc))) / (1.0 - cc)) +
           2;
}

void FarWakes::find_reaches(Nodes& nodes) const {
    Sample sample;
    const std::vector<KernelSource> source{{0.0, 0.0, 1.0, 0.0}};
    sum_wakes(KernelInternals::constants(unit_), unit_, Accuracy::full, source,
              sample.targets(polar_, 0, sample.x.size()));
    nodes.reach.assign(most_first, Sample::distance(Sample::distances)); // too far, unless it is found below
    for (std::size_t k = nodes.last_for(Sample::distance(Sample::distances)); k > 0; --k) {
        for (std::size_t i = 0; i < sample.x.size(); i += heat_lanes)
            subtract_heat(nodes.at(k), source.front(), sample.targets(polar_, i, heat_lanes));
        std::size_t within = Sample::distances;
        while (within > 0 && sample.largest(within - 1, 0, strain_parts) <= strain_error_ &&
               (!polar_ || sample.largest(within - 1, strain_parts, all_parts) <= polar_error_))
            --within;
        if (k <= most_first)
            nodes.reach[k - 1] = Sample::distance(within);
    }
}

std::vector<FarWakes::Octave> FarWakes::octaves(const Nodes& nodes, std::size_t first, double diagonal,
                                                double side) const {
    std::vector<Octave> found;
    for (std::size_t last = nodes.last_for(diagonal); first < last;) {
        const std::size_t end = std::min(last, std::max(first + 1, 3 * first / 2));
        const double width = nodes.width_at(square(nodes.root_time(end - 1))), box = side + 2.0 * width;
        const double largest = std::sqrt(cutoff_) / nodes.root_time(first);
        found.push_back({first, end,
                         static_cast<std::size_t>(std::ceil(largest * box * 0.5 * std::numbers::inv_pi)),
                         box});
        first = end;
    }
    return found;
}

/// ns, as measured (bench_many_rods); what is compared are ways of one sum.
double FarWakes::cost(const Nodes& nodes, std::size_t first, const Crowd& crowd) const {
    const double near =
        std::min(crowd.count, std::numbers::pi * square(nodes.reach[first - 1]) * crowd.density);
    double sum = crowd.count * near * (polar_ ? 40.0 : 30.0);
    for (const Octave& one : octaves(nodes, first, crowd.diagonal, crowd.side)) {
        if (one.half > largest_half)
            return HUGE_VAL;
        const double grid = 3.0 * static_cast<double>(one.half) + 50.0,
                     count = static_cast<double>(one.last - one.first);
        const double transform = 2.0 * square(grid) * std::log2(grid) + 60.0 * crowd.count;
        sum += (count + (polar_ ? 4.0 : 2.0)) * transform;
    }
    return sum;
}

FarWakes::Plan FarWakes::plan(std::span<const KernelSource> rods) const {
    const Extent extent = extent_of(rods);
    const Crowd crowd{
        static_cast<double>(rods.size()), std::hypot(extent.width, extent.height), extent.side(),
        static_cast<double>(rods.size()) / (std::max(extent.width, 1.0) * std::max(extent.height, 1.0))};
    Plan best{0, 0, 0.0, HUGE_VAL};
    if (crowd.diagonal > largest_crowd)
        return best;
    for (std::size_t way = 0; way < nodes_.size(); ++way)
        for (std::size_t first = 1; first <= most_first; ++first)
            if (const double reach = nodes_[way].reach[first - 1];
                reach < Sample::distance(Sample::distances - 1))
                if (const double ns = cost(nodes_[way], first, crowd); ns < best.cost)
                    best = {way, first, reach, ns};
    return best;
}

namespace {

/// Points of a disc of radius 1 around a source that heads along x, on one side of it: in vectors of 8.
struct Disc {
    static constexpr std::size_t rings = 20, directions = 24, points = rings * directions;
    std::vector<double> x, y;

    Disc() {
        for (std::size_t k = 0; k < rings; ++k)
            for (std::size_t i = 0; i < directions; ++i) {
                const double r = std::sin(0.5 * std::numbers::pi * (static_cast<double>(k) + 1.0) / rings),
                             angle = std::numbers::pi * (static_cast<double>(i) + 0.5) / directions;
                x.push_back(r * std::cos(angle));
                y.push_back(r * std::sin(angle));
            }
    }

    /// The polynomials of NearHeat at the points, a column each.
    Eigen::MatrixXd polynomials(bool odd) const {
        Eigen::MatrixXd all(points, NearHeat::terms);
        for (std::size_t p = 0; p < points; ++p) {
            Eigen::Index column = 0;
            double row = odd ? y[p] : 1.0;
            for (std::size_t j = 0; 2 * j <= NearHeat::degree; ++j, row *= y[p] * y[p])
                for (std::size_t i = 0; i <= NearHeat::degree - 2 * j; ++i)
                    all(static_cast<Eigen::Index>(p), column++) = row * std::pow(x[p], static_cast<int>(i));
        }
        return all;
    }
};

/// What nodes give at targets around a source that heads along x, in its parts (NearHeat::part).
class HeatField {
public:
    HeatField(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
        lab_.resize(static_cast<Eigen::Index>(x_.size()), all_parts);
        lab_.setZero();
    }

    void add(const HeatNode& node) {
        for (std::size_t i = 0; i < x_.size(); i += heat_lanes) {
            KernelTargets targets{x_.data() + i, y_.data() + i, heat_lanes, {}};
            for (int k = 0; k < all_parts; ++k)
                targets.sum[k] = &lab_(static_cast<Eigen::Index>(i), k);
            subtract_heat(node, {0.0, 0.0, 1.0, 0.0}, targets);
        }
    }

    Eigen::VectorXd part(int k) const {
        switch (k) {
        case 0:
            return -(lab_.col(0) + lab_.col(2));
        case 1:
            return lab_.col(2) - lab_.col(0);
        case 2:
            return -2.0 * lab_.col(1);
        default:
            return -lab_.col(k);
        }
    }

private:
    std::vector<double> x_, y_;
    Eigen::MatrixXd lab_; ///< less than nothing, as subtract_heat has it
};

/// What nodes give their rod itself.
std::array<double, all_parts> own_heat(const FarWakes::Nodes& nodes, std::size_t first) {
    HeatField field{std::vector<double>(heat_lanes), std::vector<double>(heat_lanes)};
    for (std::size_t k = first; k < nodes.last_for(0.0); ++k)
        field.add(nodes.at(k));
    std::array<double, all_parts> own;
    for (int k = 0; k < all_parts; ++k)
        own[k] = field.part(k)[0];
    return own;
}

} // namespace

const NearHeat& FarWakes::near_heat(const Plan& plan) const {
    const std::scoped_lock lock(mutex_);
    const std::pair key{plan.nodes, plan.first};
    const auto found = near_.find(key);
    return found != near_.end() ? found->second : near_.emplace(key, make_near_heat(plan)).first->second;
}

NearHeat FarWakes::make_near_heat(const Plan& plan) const {
    const Nodes& nodes = nodes_[plan.nodes];
    NearHeat near{plan.reach, cutoff_, {}, {}, own_heat(nodes, plan.first)};
    const Disc disc;
    std::vector<double> x = disc.x, y = disc.y;
    for (std::size_t p = 0; p < x.size(); ++p) {
        x[p] *= plan.reach;
        y[p] *= plan.reach;
    }
    HeatField field(x, y);
    const Eigen::HouseholderQR<Eigen::MatrixXd> even(disc.polynomials(false)), odd(disc.polynomials(true));
    const Eigen::MatrixXd columns[2] = {disc.polynomials(false), disc.polynomials(true)};
    std::size_t k = nodes.last_for(plan.reach);
    for (; k > plan.first; --k) { // as many as the polynomials can do
        HeatField more = field;
        more.add(nodes.at(k - 1));
        std::array<std::array<double, NearHeat::terms>, all_parts> part{};
        bool fits = true;
        for (int p = 0; p < (polar_ ? all_parts : strain_parts) && fits; ++p) {
            const Eigen::VectorXd wanted = more.part(p);
            const Eigen::VectorXd c = (NearHeat::odd[p] ? odd : even).solve(wanted);
            fits = (columns[NearHeat::odd[p]] * c - wanted).cwiseAbs().maxCoeff() <=
                   0.2 * (p < strain_parts ? strain_error_ : polar_error_);
            std::ranges::copy(c, part[p].begin());
        }
        if (!fits)
            break;
        near.part = part;
        field = more;
    }
    for (std::size_t first = plan.first; first < k; ++first)
        near.nodes.push_back(nodes.at(first));
    return near;
}

namespace {

/// Forces that have spread by shear and by longitudinal motion, as modes: x components real, y imaginary.
struct Spread {
    std::vector<fourier::Complex> shear, longitudinal;
};

/// A mode's displacement, and its wave vector.
struct Mode {
    double qx, qy;
    fourier::Complex ux, uy;
};

fourier::Complex conjugate(fourier::Complex z) { return {z.re, -z.im}; }
fourier::Complex times_i(fourier::Complex z) { return {-z.im, z.re}; }

/// The modes of two real fields that one complex field has as its parts.
Mode forces_of(std::span<const fourier::Complex> both, std::size_t i) {
    const fourier::Complex here = both[i], opposite = conjugate(both[both.size() - 1 - i]);
    return {0.0, 0.0, 0.5 * (here + opposite), -0.5 * times_i(here - opposite)};
}

Mode displacement_of(const Spread& spread, std::size_t i, double qx, double qy) {
    const Mode t = forces_of(spread.shear, i), l = forces_of(spread.longitudinal, i);
    const double inverse = 1.0 / std::max(qx * qx + qy * qy, 1e-300); // of q = 0 nothing is asked
    const fourier::Complex along = inverse * (qx * (l.ux - t.ux) + qy * (l.uy - t.uy));
    return {qx, qy, t.ux + qx * along, t.uy + qy * along};
}

// What rods are given, two real fields at a time.

fourier::Complex normal_strains(const Mode& m) { return times_i(m.qx * m.ux) - m.qy * m.uy; }
fourier::Complex shear_strain(const Mode& m) { return 0.5 * times_i(m.qy * m.ux + m.qx * m.uy); }
fourier::Complex laplacian(const Mode& m) { return -(m.qx * m.qx + m.qy * m.qy) * (m.ux + times_i(m.uy)); }
fourier::Complex gradient(const Mode& m) {
    const fourier::Complex divergence = m.qx * m.ux + m.qy * m.uy;
    return (-m.qx) * divergence - m.qy * times_i(divergence);
}

/// One octave's work.
class Mesh {
public:
    Mesh(double box, std::size_t half, Team& team, std::size_t width, bool both)
        : unit_(2.0 * std::numbers::pi / box), half_(half), team_(team), transform_(box, half, team, width),
          per_area_(1.0 / (box * box)) {
        spread_.shear.resize(transform_.modes().size());
        if (both)
            spread_.longitudinal.resize(transform_.modes().size());
    }

    /// Forces at places (layout of poses) that have spread for a time.
    void add(std::span<const double> places, std::span<const fourier::Complex> forces, const HeatNode& node) {
        transform_.place(places);
        transform_.to_modes(forces);
        const std::vector<double> shear = decay(0.25 / node.a), longitudinal = decay(0.25 / node.b);
        const double weight = node.weight * per_area_;
        team_.run(side(), [&](std::size_t row) {
            add_row(row, weight, shear, spread_.shear);
            if (!spread_.longitudinal.empty())
                add_row(row, weight, longitudinal, spread_.longitudinal);
        });
    }

    void place(std::span<const double> places) { transform_.place(places); }

    /// A pair of fields at the places.
    template<class Of>
    void read(const Of& of, std::span<fourier::Complex> values) {
        if (spread_.longitudinal.empty())
            spread_.longitudinal = spread_.shear;
        team_.run(side(), [&](std::size_t row) {
            for (std::size_t column = 0, i = row * side(); column < side(); ++column, ++i)
                transform_.modes()[i] = of(displacement_of(spread_, i, wave(row), wave(column)));
        });
        transform_.to_points(values);
    }

private:
    std::size_t side() const { return transform_.side(); }
    double wave(std::size_t index) const {
        return unit_ * (static_cast<double>(index) - static_cast<double>(half_));
    }

    std::vector<double> decay(double spread) const {
        std::vector<double> by_wave(side());
        for (std::size_t k = 0; k < side(); ++k)
            by_wave[k] = std::exp(-spread * wave(k) * wave(k));
        return by_wave;
    }

    void add_row(std::size_t row, double weight, const std::vector<double>& decay,
                 std::vector<fourier::Complex>& to) {
        const double all = weight * decay[row];
        const fourier::Complex* from = transform_.modes().data() + row * side();
        for (std::size_t column = 0; column < side(); ++column) {
            fourier::Complex& sum = to[row * side() + column];
            sum = sum + (all * decay[column]) * from[column];
        }
    }

    double unit_;
    std::size_t half_;
    Team& team_;
    NonuniformFft transform_;
    double per_area_;
    Spread spread_;
};

} // namespace

namespace {

/// Forces of a node, in the layout of poses: those of rods that are felt where rods are.
struct Forces {
    std::vector<double> places;
    std::vector<fourier::Complex> weights;
};

void find_forces(std::span<const KernelSource> rods, const Extent& extent, double time, double felt,
                 Forces& forces) {
    forces.places.clear();
    forces.weights.clear();
    for (const KernelSource& rod : rods) {
        const double x = rod.x - rod.cosine * time - extent.x, y = rod.y - rod.sine * time - extent.y;
        if (x < -felt || x > extent.width + felt || y < -felt || y > extent.height + felt)
            continue;
        forces.places.insert(forces.places.end(), {x, y, 0.0});
        forces.weights.push_back({rod.cosine, rod.sine});
    }
}

std::vector<double> places_of(std::span<const KernelSource> rods, const Extent& extent) {
    std::vector<double> places;
    for (const KernelSource& rod : rods)
        places.insert(places.end(), {rod.x - extent.x, rod.y - extent.y, 0.0});
    return places;
}

/// Adds a mesh's fields to the sums.
void give(Mesh& mesh, std::size_t rods, std::span<double* const> sums) {
    std::vector<fourier::Complex> values(rods);
    const auto add = [&](const auto& of, double* real, double* imaginary) {
        mesh.read(of, values);
        for (std::size_t a = 0; a < rods; ++a) {
            real[a] += values[a].re;
            if (imaginary != nullptr)
                imaginary[a] += values[a].im;
        }
    };
    add(normal_strains, sums[0], sums[2]);
    add(shear_strain, sums[1], nullptr);
    if (sums.size() > strain_parts) {
        add(laplacian, sums[3], sums[4]);
        add(gradient, sums[5], sums[6]);
    }
}

} // namespace

void FarWakes::add(const Plan& plan, std::span<const KernelSource> rods, Team& team,
                   std::span<double* const> sums) const {
    const Extent extent = extent_of(rods);
    const Nodes& nodes = nodes_[plan.nodes];
    Forces forces;
    for (const Octave& octave :
         octaves(nodes, plan.first, std::hypot(extent.width, extent.height), extent.side())) {
        Mesh mesh(octave.box, octave.half, team, width_, unit_.medium().eta > 0.0);
        for (std::size_t k = octave.first; k < octave.last; ++k) {
            const HeatNode node = nodes.at(k);
            find_forces(rods, extent, node.time, nodes.width_at(node.time), forces);
            mesh.add(forces.places, forces.weights, node);
        }
        mesh.place(places_of(rods, extent));
        give(mesh, rods.size(), sums);
    }
}

} // namespace rodwake::elastic
