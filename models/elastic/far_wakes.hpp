#pragma once
// Sums of the wakes of many rods in a time that hardly grows faster than their number: near ones one by one,
// far ones as drifting heat (heat_nodes.hpp) on meshes.
//
// Nodes lie at s = sqrt(t) = h (k + c (sqrt(k^2 + 100) - 10)): steps are short for near pairs, and longer for
// far ones, past which a Gaussian goes within a time of sqrt(t). To each node of the wakes' sum over time
// belongs one Gaussian, that of all rods, each n t behind its rod, and non-uniform Fourier transforms add
// them up (heat_mesh.hpp). Later nodes are smoother: each octave of them has a mesh of its own, whose box
// keeps a Gaussian's length from its images. Of pairs nearer than the reach of the error the nodes' part is
// taken off again and the exact field put in.
//
// Error: what the tolerances say, by measurement (test_far_wakes.cpp, studies/reports/rods.md "Many rods"),
// for a crowd whose error_growth is at most 1; of others that times as much. It is random from rod to rod,
// and as rods move the sums are rough by as much. Domain: 0 <= eta <= 20. Cost: N (near pairs + nodes) + sum
// of the meshes, some N^(1/2) nodes of a crowd of even density.
//
// Bits depend neither on threads nor on the vectors of a machine, but on its C library.

#include "heat_mesh.hpp"
#include "rodwake/core/parallel.hpp"

#include <map>
#include <memory>
#include <mutex>

namespace rodwake::elastic {

class FarWakes {
public:
    /// Largest eta: beyond it the Gaussians of the longitudinal motion are too wide beside those of shear.
    static constexpr double largest_eta = 20.0;

    /// By how much errors of single wakes add up beyond the tolerances, about: they do the more the denser
    /// the rods are, and those of rods that lie close together and walk alike add up without cancelling.
    static double error_growth(std::span<const KernelSource> rods_in_xi, bool polar);

    /// Errors of a strain and, if `polar`, a polar vector, in f/mu per length and its square.
    FarWakes(const Medium& medium, double strain_tolerance, double polar_tolerance, bool polar);

    /// A way to place the nodes.
    struct Nodes {
        double step, wider;        ///< h and c above
        double eta, cutoff;        ///< Gaussians below e^-cutoff are not felt
        std::vector<double> reach; ///< by the first node

        double root_time(std::size_t k) const;
        HeatNode at(std::size_t k) const;
        std::size_t last_for(double distance) const;
        double cutoff_at(double time) const; ///< of the Gaussian there, which is lower and wider
        double width_at(double time) const;
    };
    struct QuadraturePlan {
        std::size_t nodes; ///< which of the ways to place them
        std::size_t first; ///< node from which on the wakes are drifting heat, counted from 1
        double reach;      ///< pairs nearer than this, in xi, are near
        double cost;       ///< ns of one core, roughly
    };
    /// The cheapest way.
    QuadraturePlan plan(std::span<const KernelSource> rods) const;

    /// Adds the far wakes to the sums (all_parts or strain_parts of them); rods and sums in xi.
    void add(const QuadraturePlan& plan, std::span<const KernelSource> rods, ThreadPool& team,
             std::span<double* const> sums) const;

    /// What add() gave pairs nearer than the reach; lives as long as this.
    const NearHeat& near_heat(const QuadraturePlan& plan) const;

private:
    /// Nodes from first to last in one mesh.
    struct Octave {
        std::size_t first, last, half; ///< half: largest mode
        double box;
    };
    std::vector<Octave> octaves(const Nodes& nodes, std::size_t first, double diagonal, double side) const;

    Field unit_; ///< at xi = 1
    bool polar_;
    double strain_error_, polar_error_; ///< of one wake, in xi
    double cutoff_;
    std::vector<Nodes> nodes_;
    std::vector<MeshKernel> kernels_; ///< from the narrowest on
    mutable std::mutex mutex_;
    mutable std::vector<std::unique_ptr<HeatMesh>> meshes_; ///< idle ones, for their memory
    mutable std::map<std::pair<std::size_t, std::size_t>, const NearHeat>
        near_; ///< made when first asked for
};

} // namespace rodwake::elastic
