#include "wake_kernel.hpp"

#include "rodwake/core/error.hpp"

#include "geometry.hpp"

#include <cmath>
#include <string>

namespace rodwake::elastic {

namespace {

void require_length(std::size_t length, std::size_t wanted, const char* name) {
    if (length != wanted)
        throw InputError(std::string(name) + " has " + std::to_string(length) + " numbers for " +
                         std::to_string(wanted) + " targets: give them the same length");
}

} // namespace

KernelSource kernel_source(const Source& source) {
    return {source.x, source.y, std::cos(source.heading), std::sin(source.heading)};
}

std::vector<KernelSource> kernel_sources(std::span<const Source> sources) {
    std::vector<KernelSource> all;
    all.reserve(sources.size());
    for (const Source& source : sources)
        all.push_back(kernel_source(source));
    return all;
}

void require_lengths(std::size_t targets, const StrainSums& sums) {
    require_length(sums.xx.size(), targets, "xx");
    require_length(sums.xy.size(), targets, "xy");
    require_length(sums.yy.size(), targets, "yy");
}

void require_lengths(std::size_t targets, const PolarSums& sums) {
    require_length(sums.laplacian_x.size(), targets, "laplacian_x");
    require_length(sums.laplacian_y.size(), targets, "laplacian_y");
    require_length(sums.gradient_x.size(), targets, "gradient_x");
    require_length(sums.gradient_y.size(), targets, "gradient_y");
}

KernelMedium KernelInternals::constants(const Field& field) {
    const auto& c = FieldInternals::constants(field);
    // eta < 0: no point is in the kernel's range, the field does them all
    const double c_shear = field.medium().eta < 0.0 ? std::nan("") : c.c_shear;
    return {c_shear, c.nu, c.delta, c.inverse_nu};
}

void exact_parts(const Field& field, const KernelSource& source, double x, double y, bool polar,
                 double* parts) {
    const Vector offset = turned(Vector{x - source.x, y - source.y}, source.cosine, -source.sine);
    const FieldValues own = field.at(offset.x, offset.y, {.strain = true, .polar = polar});
    const SymmetricTensor strain = turned(own.strain, source.cosine, source.sine);
    parts[0] = strain.xx;
    parts[1] = strain.xy;
    parts[2] = strain.yy;
    if (!polar)
        return;
    const Vector laplacian = turned(own.laplacian, source.cosine, source.sine);
    const Vector gradient = turned(own.gradient_of_trace, source.cosine, source.sine);
    parts[3] = laplacian.x;
    parts[4] = laplacian.y;
    parts[5] = gradient.x;
    parts[6] = gradient.y;
}

WakeKernel::WakeKernel(const Medium& medium, Accuracy accuracy)
    : field_(medium), constants_(KernelInternals::constants(field_)), accuracy_(accuracy) {}

void WakeKernel::strain(std::span<const Source> sources, FieldPoints targets, const StrainSums& sums) const {
    require_length(targets.y.size(), targets.x.size(), "y");
    require_lengths(targets.x.size(), sums);
    sum_wakes(constants_, field_, accuracy_, kernel_sources(sources),
              {targets.x.data(),
               targets.y.data(),
               targets.x.size(),
               {sums.xx.data(), sums.xy.data(), sums.yy.data()}});
}

void WakeKernel::strain_and_polar(std::span<const Source> sources, FieldPoints targets,
                                  const StrainSums& strain, const PolarSums& polar) const {
    require_length(targets.y.size(), targets.x.size(), "y");
    require_lengths(targets.x.size(), strain);
    require_lengths(targets.x.size(), polar);
    sum_wakes(constants_, field_, accuracy_, kernel_sources(sources),
              {targets.x.data(),
               targets.y.data(),
               targets.x.size(),
               {strain.xx.data(), strain.xy.data(), strain.yy.data(), polar.laplacian_x.data(),
                polar.laplacian_y.data(), polar.gradient_x.data(), polar.gradient_y.data()}});
}

SymmetricTensor WakeKernel::strain(const Source& source, double x, double y) const {
    SymmetricTensor sum;
    const KernelSource item = kernel_source(source);
    sum_wakes(constants_, field_, accuracy_, {&item, 1}, {&x, &y, 1, {&sum.xx, &sum.xy, &sum.yy}});
    return sum;
}

} // namespace rodwake::elastic
