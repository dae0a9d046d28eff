#include "far_wakes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

/// What one wake may be wrong by, in xi: a small part of a sum's error, since few are at the reach, or where
/// a mesh is worst, and signs differ; the wider the wakes, the more do. Far wakes as a whole are not small
/// beside it.
double error_of_one(double tolerance, double eta) {
    return std::clamp(0.12 * tolerance / std::sqrt(1.0 + eta), 1e-13, 1e-4);
}

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
    : unit_({medium.eta, 1.0}), polar_(polar),
      strain_error_(error_of_one(strain_tolerance * medium.xi, medium.eta)),
      polar_error_(error_of_one(polar_tolerance * square(medium.xi), medium.eta)),
      cutoff_(-std::log(polar ? std::min(strain_error_, polar_error_) : strain_error_)) {
    for (std::size_t width = MeshKernel::width_for(0.0); width <= MeshKernel::width_for(1.3 * cutoff_);
         ++width)
        kernels_.emplace_back(width);
    for (const auto& [step, wider] : {std::pair{1.0, 0.8}, {0.8, 1.6}, {1.2, 0.8}}) {
        nodes_.push_back({step / std::sqrt(cutoff_), wider, medium.eta, cutoff_, {}});
        find_reaches(nodes_.back());
    }
}

/// A node gives strains of some 0.1/t, but the more rods feel it the wider it is.
double FarWakes::Nodes::cutoff_at(double time) const {
    return std::max(cutoff - 1.0 - std::log(time) * (time < 1.0 ? 1.0 : 0.25), 4.0);
}

double FarWakes::Nodes::width_at(double time) const {
    return 2.0 * std::sqrt((1.0 + eta) * time * cutoff_at(time));
}

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
        const double root = nodes.root_time(first), largest = std::sqrt(nodes.cutoff_at(root * root)) / root;
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
    double sum = crowd.count * near * (polar_ ? 20.0 : 13.0);
    for (const Octave& one : octaves(nodes, first, crowd.diagonal, crowd.side)) {
        if (one.half > largest_half)
            return HUGE_VAL;
        const double grid = 2.4 * static_cast<double>(one.half) + 30.0,
                     count = static_cast<double>(one.last - one.first);
        const double transform = 0.5 * square(grid) * std::log2(grid) + 35.0 * crowd.count;
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

const NearHeat& FarWakes::near_heat(const Plan& plan) const {
    const std::scoped_lock lock(mutex_);
    const std::pair key{plan.nodes, plan.first};
    const auto found = near_.find(key);
    return found != near_.end() ? found->second : near_.emplace(key, make_near_heat(plan)).first->second;
}

NearHeat FarWakes::make_near_heat(const Plan& plan) const {
    const Nodes& nodes = nodes_[plan.nodes];
    std::vector<HeatNode> felt;
    for (std::size_t k = plan.first; k < nodes.last_for(plan.reach); ++k)
        felt.push_back(nodes.at(k));
    NearHeat near =
        elastic::near_heat(felt, plan.reach, std::min(strain_error_, polar_ ? polar_error_ : 1.0), polar_);
    near.fine = strain_error_ >= 1e-8;
    const std::array<double, heat_lanes> place{};
    std::array<std::array<double, heat_lanes>, all_parts> sums{};
    KernelTargets targets{place.data(), place.data(), heat_lanes, {}};
    for (int k = 0; k < all_parts; ++k)
        targets.sum[k] = sums[k].data();
    for (const HeatNode& node : felt)
        subtract_heat(node, {0.0, 0.0, 1.0, 0.0}, targets);
    for (int k = 0; k < all_parts; ++k)
        near.own[k] = -sums[k][0];
    return near;
}

std::unique_ptr<HeatMesh> FarWakes::idle_mesh() const {
    const std::scoped_lock lock(mutex_);
    if (meshes_.empty())
        return std::make_unique<HeatMesh>(kernels_);
    std::unique_ptr<HeatMesh> mesh = std::move(meshes_.back());
    meshes_.pop_back();
    return mesh;
}

void FarWakes::add(const Plan& plan, std::span<const KernelSource> rods, Team& team,
                   std::span<double* const> sums) const {
    const Extent extent = extent_of(rods);
    const Nodes& nodes = nodes_[plan.nodes];
    std::unique_ptr<HeatMesh> mesh = idle_mesh();
    NearSources sources;
    sources.reserve(rods.size());
    for (const KernelSource& rod : rods)
        sources.add(rod, 0.0);
    for (const Octave& octave :
         octaves(nodes, plan.first, std::hypot(extent.width, extent.height), extent.side())) {
        const double margin = 0.5 * (octave.box - extent.side());
        mesh->begin(extent.x - margin, extent.y - margin, octave.box, octave.half, team);
        for (std::size_t k = octave.first; k < octave.last; ++k) {
            const HeatNode node = nodes.at(k);
            mesh->add(sources, node, nodes.cutoff_at(node.time), margin, nodes.width_at(node.time));
        }
        const double time = nodes.at(octave.first).time;
        mesh->read(sources, nodes.cutoff_at(time), sums);
    }
    const std::scoped_lock lock(mutex_);
    meshes_.push_back(std::move(mesh));
}

} // namespace rodwake::elastic
