#include "far_wakes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace rodwake::elastic {

namespace {

/// What one wake may be wrong by, in xi: a small part of a sum's error, since few are at the reach, or where
/// a mesh is worst, and signs differ; the wider the wakes, the more do. Far wakes as a whole are not small
/// beside it.
double error_of_one(double tolerance, double eta) {
    return std::clamp(0.08 * tolerance / std::sqrt(1.0 + eta), 1e-13, 1e-4);
}

constexpr std::size_t most_first = 48; ///< first nodes that are thought of
/// Rods a xi^2: up to here errors were measured.
constexpr double densest = 4.0;

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

// Where what is left of a wake is looked at.
constexpr std::size_t distances = 100;
double distance_of(std::size_t k) { return std::pow(1.06, static_cast<double>(k)); }

/// Largest strain, and polar vector, that functions give.
std::pair<double, double> largest_of(const WakeFunctions& f, const Field& field, double distance) {
    // In directions from a rod along x, in vectors; denser behind it.
    constexpr std::size_t count = 3 * heat_lanes;
    struct Directions {
        double cosine[count], sine[count];
    };
    static const Directions to = [] {
        Directions all{};
        for (std::size_t i = 0; i < count; ++i) {
            const double beside = (static_cast<double>(i) + 0.01) / count,
                         angle = std::numbers::pi * (1.0 - beside * beside);
            all.cosine[i] = std::cos(angle);
            all.sine[i] = std::sin(angle);
        }
        return all;
    }();
    std::pair<double, double> largest{0.0, 0.0};
    for (std::size_t i = 0; i < count; i += heat_lanes) {
        double parts[all_parts][heat_lanes];
        parts_at(f, field, 0.5 * distance, to.cosine + i, to.sine + i, parts);
        for (int k = 0; k < all_parts; ++k)
            for (const double part : parts[k]) {
                double& most = k < strain_parts ? largest.first : largest.second;
                most = std::max(most, std::abs(part));
            }
    }
    return largest;
}

constexpr std::size_t largest_half = 2500; ///< modes of a mesh in each direction: some 2 GB
constexpr double largest_crowd = 1e5;      ///< beyond it meshes never pay

constexpr double bend = 10.0; ///< node at which steps have widened

} // namespace

/// Errors of wakes are alike where rods are within half a xi and have one heading, and independent otherwise:
/// their squares add up over cells of that size, each as large as the sum of its rods' headings, and by a
/// fifth as the number of its rods, since part of an error does not depend on the heading. A cell alone
/// counts too: somewhere its error is largest. Factors are measured, with room (test_far_wakes.cpp).
double FarWakes::error_growth(std::span<const KernelSource> rods_in_xi, bool polar) {
    struct Cell {
        double count = 0.0, cosine = 0.0, sine = 0.0;
    };
    constexpr double side = 0.5;
    const Extent extent = extent_of(rods_in_xi);
    std::unordered_map<std::uint64_t, Cell> cells(rods_in_xi.size());
    for (const KernelSource& rod : rods_in_xi) {
        Cell& cell = cells[static_cast<std::uint64_t>((rod.x - extent.x) / side) << 32U |
                           static_cast<std::uint64_t>((rod.y - extent.y) / side)];
        cell.count += 1.0;
        cell.cosine += rod.cosine;
        cell.sine += rod.sine;
    }
    double squares = 0.0, largest = 0.0;
    for (const auto& [key, cell] : cells) {
        const double aligned = square(cell.cosine) + square(cell.sine);
        squares += aligned + 0.2 * square(cell.count);
        largest = std::max(largest, aligned);
    }
    const double area = std::max(extent.width, 1.0) * std::max(extent.height, 1.0);
    return (polar ? 1.6 : 0.8) * std::sqrt(1.3 * squares / area + 0.003 * largest);
}

FarWakes::FarWakes(const Medium& medium, double strain_tolerance, double polar_tolerance, bool polar)
    : unit_({medium.eta, 1.0}), polar_(polar),
      strain_error_(error_of_one(strain_tolerance * medium.xi, medium.eta)),
      polar_error_(error_of_one(polar_tolerance * square(medium.xi), medium.eta)),
      cutoff_(-std::log(polar ? std::min(strain_error_, polar_error_) : strain_error_)) {
    for (std::size_t width = MeshKernel::width_for(0.0); width <= MeshKernel::width_for(1.3 * cutoff_);
         ++width)
        kernels_.emplace_back(width);
    for (const auto& [step, wider] : {std::pair{1.0, 0.8}, {0.8, 1.6}, {1.2, 0.8}}) {
        Nodes& nodes = nodes_.emplace_back(Nodes{step / std::sqrt(cutoff_), wider, medium.eta, cutoff_, {}});

        // The first node decides within which distance the rest of a wake is not small.
        std::vector<WakeFunctions> left;
        for (std::size_t k = 0; k < distances; ++k)
            left.push_back(exact_functions(nodes.eta, 0.5 * distance_of(k)));
        const auto small = [&](std::size_t k) {
            const auto [strain_left, polar_left] = largest_of(left[k], unit_, distance_of(k));
            return strain_left <= strain_error_ && (!polar_ || polar_left <= polar_error_);
        };
        nodes.reach.assign(most_first, distance_of(distances)); // too far, unless it is found below
        for (std::size_t k = nodes.last_for(distance_of(distances)); k > 0; --k) {
            for (std::size_t i = 0; i < distances; ++i)
                take_node(nodes.at(k), nodes.eta, 0.5 * distance_of(i), left[i]);
            std::size_t within = k > most_first ? 0 : distances;
            while (within > 0 && small(within - 1))
                --within;
            if (k <= most_first)
                nodes.reach[k - 1] = distance_of(within);
        }
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
    const double root = root_time(k),
                 length = step * (1.0 + wider * number / std::sqrt(number * number + bend * bend));
    return {root * root, 2.0 * root * length};
}

/// The node from which on all Gaussians have left a place for one `distance` behind it.
std::size_t FarWakes::Nodes::last_for(double distance) const {
    const double root = std::sqrt((1.0 + eta) *
                                  cutoff_at(std::max(distance, 1.0))), // t - 2 root sqrt(t) = distance
        end = root + std::sqrt(square(root) + distance);
    const double q = end / step + wider * bend, cc = wider * wider; // of root_time(k) = end
    return static_cast<std::size_t>((q - wider * std::sqrt(q * q + bend * bend * (1.0 - cc))) / (1.0 - cc)) +
           2;
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

FarWakes::QuadraturePlan FarWakes::plan(std::span<const KernelSource> rods) const {
    const Extent extent = extent_of(rods);
    const double count = static_cast<double>(rods.size()), diagonal = std::hypot(extent.width, extent.height),
                 density = count / (std::max(extent.width, 1.0) * std::max(extent.height, 1.0));
    QuadraturePlan best{0, 0, 0.0, HUGE_VAL};
    if (diagonal > largest_crowd || density > densest)
        return best;
    // ns, as measured (bench_many_rods); what is compared are ways of one sum.
    const auto cost_of = [&](const Nodes& nodes, std::size_t first) {
        const double near = std::min(count, std::numbers::pi * square(nodes.reach[first - 1]) * density);
        double sum = count * near * (polar_ ? 20.0 : 13.0);
        for (const Octave& item : octaves(nodes, first, diagonal, extent.side())) {
            if (item.half > largest_half)
                return HUGE_VAL;
            const double grid = 2.4 * static_cast<double>(item.half) + 30.0,
                         transforms = static_cast<double>(item.last - item.first) + (polar_ ? 4.0 : 2.0);
            sum += transforms * (0.5 * square(grid) * std::log2(grid) + 35.0 * count);
        }
        return sum;
    };
    for (std::size_t way = 0; way < nodes_.size(); ++way)
        for (std::size_t first = 1; first <= most_first; ++first)
            if (const double reach = nodes_[way].reach[first - 1]; reach < distance_of(distances - 1))
                if (const double ns = cost_of(nodes_[way], first); ns < best.cost)
                    best = {way, first, reach, ns};
    return best;
}

const NearHeat& FarWakes::near_heat(const QuadraturePlan& plan) const {
    const std::scoped_lock lock(mutex_);
    const std::pair key{plan.nodes, plan.first};
    if (const auto found = near_.find(key); found != near_.end())
        return found->second;
    const Nodes& nodes = nodes_[plan.nodes];
    std::vector<HeatNode> felt;
    for (std::size_t k = plan.first; k < nodes.last_for(plan.reach); ++k)
        felt.push_back(nodes.at(k));
    const double error = std::min(strain_error_, polar_ ? polar_error_ : 1.0);
    NearHeat near = elastic::near_heat(felt, nodes.eta, plan.reach, error, polar_);
    WakeFunctions own{};
    for (const HeatNode& node : felt)
        take_node(node, nodes.eta, 0.0, own);
    const double ahead[heat_lanes] = {}, aside[heat_lanes] = {};
    parts_at(own, unit_, 0.0, ahead, aside, near.own);
    return near_.emplace(key, std::move(near)).first->second;
}

void FarWakes::add(const QuadraturePlan& plan, std::span<const KernelSource> rods, ThreadPool& team,
                   std::span<double* const> sums) const {
    const Extent extent = extent_of(rods);
    const Nodes& nodes = nodes_[plan.nodes];
    std::unique_ptr<HeatMesh> mesh;
    {
        const std::scoped_lock lock(mutex_);
        if (!meshes_.empty()) {
            mesh = std::move(meshes_.back());
            meshes_.pop_back();
        }
    }
    if (!mesh)
        mesh = std::make_unique<HeatMesh>(unit_.medium().eta, kernels_);
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
