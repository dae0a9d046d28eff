#pragma once
// Which fields are kept where rods are summed over one by one, and how they turn the rods.
//
// Without self_field each rod has a field: a rod is turned by the sum of all less its own. With it one field
// of all comes first; that of each rod by itself follows for up to most_fields rods: it acts on none, and
// says what turning is a rod's own.

#include "rodwake/core/parallel.hpp"
#include "rodwake/medium/modal_field.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::medium {

class SummedFields {
public:
    /// A field takes `stride` numbers, of which the first 4 modes.size() are its amplitudes. `modes` and
    /// `team` outlive it.
    SummedFields(const ModalField& modes, const rods::Couplings& couplings, bool self_field, std::size_t rods,
                 std::size_t stride, ThreadPool& team);

    static std::size_t count(bool self_field, std::size_t rods);
    std::size_t count() const { return count(self_field_, rods_); }
    bool common() const { return self_field_; }
    bool own() const { return count() > 1 || !self_field_; }
    /// Where the field of all, and where that of a rod starts.
    std::size_t at(std::size_t rod) const { return ((self_field_ ? 1 : 0) + rod) * stride_; }

    /// Rates of the rods' coordinates.
    void rates(integrate::State poses, std::span<const double> fields, std::span<double> ydot);
    /// Turning rates by own fields; empty where these are not kept beside that of all.
    std::vector<double> own_turning(integrate::State poses, std::span<const double> fields);

private:
    double turning(integrate::State poses, std::size_t rod, std::span<const double> field,
                   std::span<const double> minus) const;

    const ModalField& modes_;
    rods::Couplings couplings_;
    bool self_field_;
    std::size_t rods_, stride_;
    ThreadPool& team_;
    std::vector<double> total_;
};

} // namespace rodwake::medium
