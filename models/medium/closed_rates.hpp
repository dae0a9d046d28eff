#pragma once
// Turning rates of rods whose fields know nothing of their past, or the turning rates alone:
// DynamicMedium::closure.
//
// first_order takes two passes. The rods' turning rates in steady fields are put into the fields
// (turning_wake.hpp), and what these make is the result. It is of first order in theta', as the fields are:
// the rates of a third pass would differ by the second.
//
// A right-hand side costs as many sums over the modes as rods, twice as many for first_order.

#include "rodwake/core/parallel.hpp"
#include "rodwake/medium/modal_field.hpp"
#include "rodwake/rods/simulate.hpp"

namespace rodwake::medium {

class ClosedRates {
public:
    /// Throws InputError as validate does, and without a closure.
    ClosedRates(const elastic::Medium& elastic, const DynamicMedium& medium, const rods::Couplings& couplings,
                std::size_t rods, std::size_t threads);

    /// Rates of the rods' coordinates, layout of rods/model.hpp. Bits do not depend on the threads.
    void rates(integrate::State poses, std::span<double> ydot);

private:
    void turn(integrate::State poses, std::span<double> ydot);
    std::span<double> field(std::size_t rod);

    ModalField modes_;
    rods::Couplings couplings_;
    bool self_field_, first_order_;
    ThreadPool team_;
    std::vector<double> fields_; ///< one after the other; with self_field a single one, of all rods
    std::vector<double> total_;  ///< their sum
};

/// rods::simulate in these rates. `rods`: in the medium's box.
rods::RodResult simulate_closed(const rods::RodProblem& rods, const DynamicMedium& medium,
                                rods::RodOptions options);

} // namespace rodwake::medium
