#include "closed_rates.hpp"

#include "rods/interaction.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/medium/turning_wake.hpp"
#include "rodwake/rods/conclude.hpp"

#include <algorithm>

namespace rodwake::medium {

ClosedRates::ClosedRates(const elastic::Medium& elastic, const DynamicMedium& medium,
                         const rods::Couplings& couplings, std::size_t rods, std::size_t threads)
    : modes_(elastic, medium), couplings_(couplings), self_field_(medium.self_field),
      first_order_(medium.closure == Closure::first_order), team_(threads),
      fields_(4 * modes_.size() * (medium.self_field ? 1 : rods)), total_(4 * modes_.size()) {
    validate(elastic, medium, rods);
    if (medium.closure == Closure::none)
        throw InputError("rates of a closure are asked for in a medium without one");
}

std::span<double> ClosedRates::field(std::size_t rod) {
    return std::span(fields_).subspan(self_field_ ? 0 : rod * total_.size(), total_.size());
}

void ClosedRates::set_steady(integrate::State poses) {
    std::ranges::fill(fields_, 0.0);
    for (std::size_t b = 0; b < poses.size() / 3; ++b)
        modes_.add_steady(rods::pose(poses, b), field(b));
}

/// Headings' rates in the fields as they are.
void ClosedRates::turn(integrate::State poses, std::span<double> ydot) {
    const std::size_t numbers = total_.size();
    std::copy_n(fields_.begin(), numbers, total_.begin());
    for (std::size_t first = numbers; first < fields_.size(); first += numbers)
        for (std::size_t i = 0; i < numbers; ++i)
            total_[i] += fields_[first + i];
    const elastic::FieldRequest request = rods::request_of(couplings_, false);
    team_.run(poses.size() / 3, [&](std::size_t a) {
        const rods::Direction n = rods::direction(poses, a);
        const std::span<const double> own = self_field_ ? std::span<const double>() : field(a);
        const elastic::FieldValues values = modes_.at(poses[3 * a], poses[3 * a + 1], request, total_, own);
        ydot[3 * a + 2] = rods::turning_rate(values, couplings_, {n.cosine, n.sine});
    });
}

void ClosedRates::rates(integrate::State poses, std::span<double> ydot) {
    const std::size_t rods = poses.size() / 3;
    for (std::size_t a = 0; a < rods; ++a) {
        const rods::Direction n = rods::direction(poses, a);
        ydot[3 * a] = n.cosine;
        ydot[3 * a + 1] = n.sine;
        ydot[3 * a + 2] = 0.0;
    }
    if (!couplings_.any() || (rods < 2 && !self_field_))
        return;
    set_steady(poses);
    turn(poses, ydot);
    if (!first_order_)
        return;
    for (std::size_t b = 0; b < rods; ++b)
        add_turning(modes_, rods::pose(poses, b), ydot[3 * b + 2], field(b));
    turn(poses, ydot);
}

rods::RodResult simulate_closed(const rods::RodProblem& rods, const DynamicMedium& medium,
                                rods::RodOptions options) {
    ClosedRates closed(*rods.medium, medium, rods.couplings, rods.rods.size(), rods.sums.threads);
    const rods::StateRates rates = [&](integrate::State y, std::span<double> ydot) { closed.rates(y, ydot); };
    options.ode.method = integrate::Method::erk;
    return rods::simulate_rates(rods, rates, medium.force_width, options);
}

} // namespace rodwake::medium
