#include "rodwake/measure/memory_kernel.hpp"

#include "laplace.hpp"
#include "stiffness_spectrum.hpp"

#include <cmath>
#include <initializer_list>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
constexpr double points_a_decade = 12.0;

Row values_of(const SmoothSampled& function, const Row& s) {
    Row values;
    for (const double at : s)
        values.push_back(1.0 / (at * laplace(function, at)));
    return values;
}

} // namespace

StiffnessSpectrum spectrum_of(std::span<const double> lag, std::span<const double> msd, const Row& s) {
    const SmoothSampled best = smooth_sampled(lag, msd, Between::cubics);
    StiffnessSpectrum spectrum{s, values_of(best, s), {}, {}, {}, {}};

    // How far the other readings put the transform off, as a share of it.
    SmoothSampled flat = best, ballistic = best;
    flat.tail_slope = 0.0;
    ballistic.start_exponent = 2.0;
    const SmoothSampled power_laws = smooth_sampled(lag, msd, Between::power_laws);
    Row shares;
    for (const double at : s) {
        const double transform = laplace(best, at);
        double off = 0.0;
        for (const SmoothSampled* other :
             std::initializer_list<const SmoothSampled*>{&flat, &ballistic, &power_laws})
            off += std::abs(laplace(*other, at) - transform);
        shares.push_back(off / transform);
    }

    // The range is the longest stretch of points with a share that is small enough.
    std::size_t longest = 0, length = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        spectrum.bias.push_back(shares[i] * spectrum.value[i]);
        length = shares[i] <= StiffnessSpectrum::largest_bias ? length + 1 : 0;
        if (length > longest) {
            longest = length;
            spectrum.low = s[i + 1 - length];
            spectrum.high = s[i];
        }
    }
    return spectrum;
}

StiffnessSpectrum stiffness_spectrum(const std::vector<LagBlock>& blocks, const Row& lag) {
    const double decades = std::log10(lag.back() / lag.front());
    const Row s = log_range(1.0 / lag.back(), 1.0 / lag.front(),
                            2 + static_cast<std::size_t>(points_a_decade * decades));
    const auto known = [&](const Row& msd) { return std::span(msd).first(lag.size()); };
    const Jackknife curves = Jackknife::of(blocks, [&](const Row& msd) {
        return values_of(smooth_sampled(lag, known(msd), Between::cubics), s);
    });
    StiffnessSpectrum spectrum = spectrum_of(lag, known(pooled(blocks, blocks.size())), s);
    spectrum.error = curves.errors();
    return spectrum;
}

MemoryKernel memory_kernel(const StiffnessSpectrum& spectrum, double mass, double temperature,
                           const std::optional<Estimate>& drag_rate) {
    MemoryKernel k;
    k.s = spectrum.s;
    const double factor = 4.0 * mass * temperature;
    const double drag = mass * (drag_rate ? drag_rate->value : unknown_error);
    const double drag_error = mass * (drag_rate ? drag_rate->error : unknown_error);
    for (std::size_t i = 0; i < k.s.size(); ++i) {
        const double s = k.s[i];
        k.total.push_back(factor * spectrum.value[i]);
        k.total_error.push_back(factor * spectrum.error[i]);
        k.bias.push_back(factor * spectrum.bias[i]);
        k.with_drag.push_back(k.total[i] - mass * s * s);
        k.kernel.push_back(k.with_drag[i] - drag * s);
        k.kernel_error.push_back(std::hypot(k.total_error[i], drag_error * s));
    }
    return k;
}

} // namespace rodwake::measure
