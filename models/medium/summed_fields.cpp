#include "summed_fields.hpp"

#include "rods/interaction.hpp"

namespace rodwake::medium {

SummedFields::SummedFields(const ModalField& modes, const rods::Couplings& couplings, bool self_field,
                           std::size_t rods, std::size_t stride, ThreadPool& team)
    : modes_(modes), couplings_(couplings), self_field_(self_field), rods_(rods), stride_(stride),
      team_(team), total_(!self_field && rods > 1 ? 4 * modes.size() : 0) {}

std::size_t SummedFields::count(bool self_field, std::size_t rods) {
    if (!self_field)
        return rods;
    return rods <= most_fields ? 1 + rods : 1;
}

double SummedFields::turning(integrate::State poses, std::size_t rod, std::span<const double> field,
                             std::span<const double> minus) const {
    const rods::Direction n = rods::direction(poses, rod);
    const elastic::FieldValues values =
        modes_.at(poses[3 * rod], poses[3 * rod + 1], rods::request_of(couplings_, false), field, minus);
    return rods::turning_rate(values, couplings_, {n.cosine, n.sine});
}

void SummedFields::rates(integrate::State poses, std::span<const double> fields, std::span<double> ydot) {
    const std::size_t columns = modes_.columns();
    if (!total_.empty())
        team_.run(total_.size() / columns, [&](std::size_t row) {
            for (std::size_t i = row * columns; i < (row + 1) * columns; ++i) {
                total_[i] = 0.0;
                for (std::size_t k = 0; k < rods_; ++k)
                    total_[i] += fields[k * stride_ + i];
            }
        });
    const bool acting = couplings_.any() && (self_field_ || rods_ > 1);
    team_.run(rods_, [&](std::size_t a) {
        const rods::Direction n = rods::direction(poses, a);
        ydot[3 * a] = n.cosine;
        ydot[3 * a + 1] = n.sine;
        ydot[3 * a + 2] = 0.0;
        if (acting)
            ydot[3 * a + 2] = self_field_ ? turning(poses, a, fields, {})
                                          : turning(poses, a, total_, fields.subspan(at(a), stride_));
    });
}

std::vector<double> SummedFields::own_turning(integrate::State poses, std::span<const double> fields) {
    if (!self_field_ || !own())
        return {};
    std::vector<double> rates(rods_);
    if (couplings_.any())
        team_.run(rods_,
                  [&](std::size_t a) { rates[a] = turning(poses, a, fields.subspan(at(a), stride_), {}); });
    return rates;
}

} // namespace rodwake::medium
