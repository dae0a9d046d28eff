#include "far_lattice.hpp"

#include "plane_waves.hpp"
#include "rod_view.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr std::size_t most_frames = 16; // of a block; more tell nothing new of it
constexpr std::size_t fewest_for_rate = 4;
constexpr int most_steps = 40;
constexpr double settled = 1e-10; // of a wave across the window

/// From their mean place.
struct FarBeads {
    double time = 0.0;
    std::vector<double> x, y;
    double xx = 0.0, xy = 0.0, yy = 0.0; ///< means of products
};

/// Sums of exp(i G_k.r), and the gradients of ln |sum|.
struct Winding {
    std::array<std::complex<double>, 3> sum{};
    std::array<Vector2, 3> slope{};
};

Winding winding(const FarBeads& beads, const std::array<Vector2, 3>& G) {
    Winding w;
    std::array<std::complex<double>, 3> by_x{}, by_y{};
    for (std::size_t i = 0; i < beads.x.size(); ++i) {
        const PhaseFactors waves = plane_waves(G, beads.x[i], beads.y[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            w.sum[k] += waves[k];
            by_x[k] += beads.x[i] * waves[k];
            by_y[k] += beads.y[i] * waves[k];
        }
    }
    for (std::size_t k = 0; k < 3; ++k) // d ln|F| = Re(i sum r exp / F) dG
        if (w.sum[k] != 0.0)
            w.slope[k] = {-(by_x[k] / w.sum[k]).imag(), -(by_y[k] / w.sum[k]).imag()};
    return w;
}

void move(std::array<Vector2, 3>& G, const Eigen::Vector4d& step) {
    G[0] = {G[0].x + step[0], G[0].y + step[1]};
    G[2] = {G[2].x + step[2], G[2].y + step[3]};
    G[1] = {G[0].x + G[2].x, G[0].y + G[2].y};
}

/// `span`: from the first frame to the last, s.
void refine(std::span<const FarBeads> frames, const PeriodicBox& box, double span, FarLattice& lattice) {
    const Eigen::Vector4d wave(2.0 * M_PI / box.x, 2.0 * M_PI / box.y, 2.0 * M_PI / box.x,
                               2.0 * M_PI / box.y);
    const auto size_of = [&](const Eigen::Vector4d& step) {
        return step.cwiseQuotient(wave).cwiseAbs().maxCoeff();
    };
    const bool moves = frames.size() >= fewest_for_rate;
    for (int k = 0; k < most_steps; ++k) {
        // Steps of G_0 and G_2, and of their rates, to the maximum, were |F| a Gaussian as it is near its
        // peak. Times count from their mean, so that the two are independent.
        Eigen::Vector4d slope = Eigen::Vector4d::Zero(), slope_of_rate = slope;
        Eigen::Matrix4d curvature = Eigen::Matrix4d::Zero(), curvature_of_rate = curvature;
        for (const FarBeads& beads : frames) {
            const Winding w = winding(beads, lattice.at(beads.time));
            const double late = beads.time - lattice.time;
            const Eigen::Vector4d gradient(w.slope[0].x + w.slope[1].x, w.slope[0].y + w.slope[1].y,
                                           w.slope[2].x + w.slope[1].x, w.slope[2].y + w.slope[1].y);
            Eigen::Matrix2d spread;
            spread << beads.xx, beads.xy, beads.xy, beads.yy;
            Eigen::Matrix4d matrix;
            matrix << 2.0 * spread, spread, spread, 2.0 * spread;
            slope += gradient;
            curvature += matrix;
            slope_of_rate += late * gradient;
            curvature_of_rate += late * late * matrix;
        }
        const Eigen::Vector4d step = curvature.ldlt().solve(slope),
                              rate_step = curvature_of_rate.ldlt().solve(slope_of_rate);
        const double now = size_of(step), later = moves ? size_of(rate_step) * span : 0.0;
        if (!std::isfinite(now) || !std::isfinite(later))
            return;
        move(lattice.peaks.G, step * (now > 0.5 ? 0.5 / now : 1.0));
        if (moves && now < 0.1) // begins once the peak is found
            move(lattice.rate, rate_step * (later > 0.5 ? 0.5 / later : 1.0));
        if (now < settled && later < settled)
            return;
    }
}

} // namespace

FarLattice far_lattice(std::span<const Frame> frames, const Layout& layout, double far_from) {
    const Frame& first = frames.front();
    const double sites =
        static_cast<double>(first.x.size()) * layout.box.area() / seen_area(layout); // if they filled the box
    FarLattice lattice;
    BraggPeaks& peaks = lattice.peaks;
    peaks = find_peaks(first.x, first.y, layout.box, sites);
    std::vector<FarBeads> far;
    const std::size_t every = (frames.size() + most_frames - 1) / most_frames;
    for (std::size_t f = 0; f < frames.size(); f += every) {
        const Frame& frame = frames[f];
        const FarField field(frame, layout, far_from);
        FarBeads& beads = far.emplace_back();
        beads.time = frame.time;
        double x = 0.0, y = 0.0;
        for (std::size_t i = 0; i < frame.x.size(); ++i)
            if (field.has(frame.x[i], frame.y[i])) {
                beads.x.push_back(frame.x[i]);
                beads.y.push_back(frame.y[i]);
                x += frame.x[i];
                y += frame.y[i];
            }
        const auto count = static_cast<double>(beads.x.size());
        for (std::size_t i = 0; i < beads.x.size(); ++i) {
            const double dx = beads.x[i] -= x / count, dy = beads.y[i] -= y / count;
            beads.xx += dx * dx / count;
            beads.xy += dx * dy / count;
            beads.yy += dy * dy / count;
        }
    }
    for (const FarBeads& item : far)
        lattice.time += item.time / static_cast<double>(far.size());
    refine(far, layout.box, far.back().time - far.front().time, lattice);
    const Winding now = winding(far.front(), lattice.at(far.front().time));
    for (std::size_t k = 0; k < 3; ++k)
        peaks.strength[k] = std::norm(now.sum[k] / static_cast<double>(far.front().x.size()));
    return lattice;
}

} // namespace rodwake::measure
