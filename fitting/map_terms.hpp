#pragma once
// The model of a map: which parameters it has, and its values and derivatives at all bins.

#include "rodwake/fitting/map.hpp"

#include <array>
#include <optional>

namespace rodwake::fitting {

/// Index of each among the parameters; -1: absent. In the order of map_parameter_names.
struct MapTerms {
    std::array<long, 16> index;

    double value(std::span<const double> p, std::size_t term, double absent) const {
        return index[term] < 0 ? absent : p[static_cast<std::size_t>(index[term])];
    }
};

/// Throws InputError for names that are unknown and for missing ones.
MapTerms map_terms(const std::vector<Parameter>& parameters);

class MapField {
public:
    MapField(const MapModel& model, const Map& map, const MapTerms& terms);

    /// From here on the constants of the medium are those of `p`, worked out once.
    void hold_medium(std::span<const double> p);

    elastic::DisplacementMap at(std::span<const double> p) const;
    /// By the parameter that is this term.
    elastic::DisplacementMap derivative(std::span<const double> p, std::size_t term) const;

private:
    using Basis = std::array<elastic::DisplacementMap, 6>;
    Basis basis(std::span<const double> p) const;
    elastic::RodSource source(std::span<const double> p) const;
    elastic::DisplacementMap unit(std::span<const double> p, std::size_t k) const;

    MapTerms terms_;
    elastic::AnisotropicField field_;
    std::size_t bins_;
    std::optional<Basis> held_; ///< of unit sources, from force to q_yxy
};

} // namespace rodwake::fitting
