#include "coupled_step.hpp"

#include "exponential_step.hpp"
#include "mode_step.hpp"

namespace rodwake::medium {

std::unique_ptr<CoupledStep> make_step(const elastic::Medium& elastic, const DynamicMedium& medium,
                                       const rods::Couplings& couplings, std::size_t rods,
                                       std::size_t threads, const rods::BodyForces& bodies) {
    if (medium.inertia > 0.0 || evaluation_of(medium, rods) == Evaluation::mesh)
        return std::make_unique<ModeStep>(elastic, medium, couplings, rods, threads, bodies);
    return std::make_unique<ExponentialStep>(elastic, medium, couplings, rods, threads, bodies);
}

std::vector<double> summed_amplitudes(const ModalField& modes, const DynamicMedium& medium, std::size_t rods,
                                      std::span<const double> fields) {
    const std::size_t amplitudes = 4 * modes.size();
    std::vector<double> sum(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(amplitudes));
    if (medium.self_field || evaluation_of(medium, rods) == Evaluation::mesh) // the first is that of all
        return sum;
    for (std::size_t rod = 1; rod < rods; ++rod)
        for (std::size_t i = 0; i < amplitudes; ++i)
            sum[i] += fields[rod * modes.numbers() + i];
    return sum;
}

std::size_t field_numbers(const DynamicMedium& medium, std::size_t rods) {
    const std::size_t half = (medium.modes + 1) / 2 - 1, size = (half + 1) * (2 * half + 1);
    const std::size_t field = (medium.inertia > 0.0 ? 8 : 4) * size;
    if (evaluation_of(medium, rods) == Evaluation::mesh)
        return field + (medium.self_field ? 0 : OwnResponse::numbers(rods));
    return field * SummedFields::count(medium.self_field, rods);
}

} // namespace rodwake::medium
