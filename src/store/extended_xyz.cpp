#include "rodwake/store/extended_xyz.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::store {

namespace {

using Text = fmt::memory_buffer;

template<class... Values>
void print(Text& out, fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(out), format, std::forward<Values>(values)...);
}

void print_vector(Text& out, const double* v, double unit) {
    print(out, " {} {} {}", v[0] / unit, v[1] / unit, v[2] / unit);
}

} // namespace

ExtendedXyzWriter::ExtendedXyzWriter(const std::filesystem::path& target, FrameLayout layout,
                                     double length_unit)
    : layout_(checked(std::move(layout))), unit_(length_unit), pending_(target) {
    if (!(unit_ > 0.0) || !std::isfinite(unit_))
        throw InputError(
            fmt::format("{}: length unit {}: must be finite and positive", target.string(), unit_));
}

void ExtendedXyzWriter::add_frame(const Frame& frame) {
    check_frame(layout_, frame, last_step_);
    const WrappedVectors position = wrap(frame.position, layout_);
    Text out;
    const auto& [x, y, z] = layout_.box;
    const auto flag = [&](std::size_t axis) { return layout_.periodic[axis] ? 'T' : 'F'; };
    print(out, "{}\n", layout_.particles());
    print(out, "Lattice=\"{} 0 0 0 {} 0 0 0 {}\" ", x / unit_, y / unit_, z / unit_);
    print(out, "Properties=species:S:1:pos:R:3:velo:R:3:id:I:1:molecule:I:1:radius:R:1:kind:S:1 ");
    print(out, "pbc=\"{} {} {}\" Time={} Step={}", flag(0), flag(1), flag(2), frame.time, frame.step);
    for (std::size_t i = 0; i < frame.observables.size(); ++i)
        print(out, " {}={}", layout_.observables[i], frame.observables[i]);
    out.push_back('\n');
    std::size_t of_rods = 0;
    for (std::size_t i = 0; i < layout_.particles(); ++i) {
        const int molecule = layout_.species[i] == 0 ? 0 : layout_.rod_of_sphere[of_rods++] + 1;
        const Species& kind = layout_.kinds[static_cast<std::size_t>(layout_.species[i])];
        print(out, "{}", kind.symbol);
        print_vector(out, &position.place[3 * i], unit_);
        print_vector(out, &frame.velocity[3 * i], unit_);
        print(out, " {} {} {} {}\n", layout_.id[i], molecule, layout_.radius[i] / unit_, kind.name);
    }
    pending_.write({out.data(), out.size()});
    last_step_ = frame.step;
}

void ExtendedXyzWriter::commit() { pending_.commit(); }

} // namespace rodwake::store
