#include "blocks.hpp"
#include "oscillator_fit.hpp"
#include "phonon_constants.hpp"
#include "phonon_sums.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/phonons.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = std::span<const PhononAccumulator>;
constexpr std::size_t fewest_blocks = 2;

/// Numbers of one branch, in this order in a row.
enum BranchNumber : std::size_t { omega, gamma, temperature, displacement, omega_static, amplitude };
constexpr std::size_t branch_numbers = 6;

/// What all data gave: start and window of the fits of the parts.
struct Guide {
    Oscillator oscillator;
    std::size_t lags = 0;
};

Guide guide_of(const Row& correlation, double step) {
    const OscillatorFit rough = fit_oscillator(correlation, step);
    if (!std::isfinite(rough.amplitude))
        return {rough.oscillator, 0};
    return {rough.oscillator, fitted_lags(rough.oscillator, step, correlation.size())};
}

/// The analysis of sums over blocks, the same for all blocks and for all but one.
class Analysis {
public:
    Analysis(const PhononAccumulator& run, const PhononSums& all)
        : layout_(run.layout()), step_(run.interval()), modes_(run.modes().size()),
          beads_(static_cast<double>(run.layout().beads)), classes_(mirror_modes(run.modes())) {
        for (const MirrorModes& mirrored : classes_) {
            const CurrentCorrelations c = branches(all, mirrored);
            guides_.push_back({guide_of(c.LL, step_), guide_of(c.TT, step_)});
        }
    }

    const std::vector<MirrorModes>& classes() const { return classes_; }
    double density() const { return beads_ * layout_.bead_mass / layout_.box.area(); }
    double qx(const MirrorModes& c) const { return 2.0 * std::numbers::pi * c.m / layout_.box.x; }
    double qy(const MirrorModes& c) const { return 2.0 * std::numbers::pi * c.n / layout_.box.y; }

    double angle(const PhononSums& sums, const MirrorModes& item) const {
        return item.m == 0 || item.n == 0 ? 0.0
                                          : polarisation_of(correlations_of(sums, item, modes_, beads_));
    }
    CurrentCorrelations branches(const PhononSums& sums, const MirrorModes& each) const {
        return turned(correlations_of(sums, each, modes_, beads_), angle(sums, each));
    }

    /// [class][L, T][BranchNumber]
    Row branch_rows(const PhononSums& sums) const {
        Row row;
        for (std::size_t i = 0; i < classes_.size(); ++i) {
            const CurrentCorrelations c = branches(sums, classes_[i]);
            for (const std::size_t branch : {0, 1}) {
                const Row& correlation = branch == 0 ? c.LL : c.TT;
                const Guide& guide = guides_[i][branch];
                const OscillatorFit fit =
                    fit_oscillator(std::span(correlation).first(guide.lags), step_, &guide.oscillator);
                const double T = correlation[0], u2 = square(sums, classes_[i], branch);
                row.insert(row.end(), {fit.oscillator.omega, fit.oscillator.gamma, T, u2,
                                       std::sqrt(T / (beads_ * u2)), fit.amplitude});
            }
        }
        return row;
    }

    /// As the members of ElasticNumbers, with the errors of the branches as weights.
    ElasticNumbers constants(const Row& rows, const Row& errors) const {
        std::vector<ModeNumbers> modes;
        for (std::size_t i = 0; i < classes_.size(); ++i) {
            const double *L = &rows[2 * i * branch_numbers], *T = L + branch_numbers;
            const double *eL = &errors[2 * i * branch_numbers], *eT = eL + branch_numbers;
            const auto weight = [](double error) { return 1.0 / (error * error); };
            modes.push_back({classes_[i].m, classes_[i].n, qx(classes_[i]), qy(classes_[i]), L[omega],
                             T[omega], L[gamma], T[gamma], weight(eL[omega]), weight(eT[omega]),
                             weight(eL[gamma]), weight(eT[gamma])});
        }
        return elastic_numbers(modes, density());
    }

private:
    double square(const PhononSums& sums, const MirrorModes& one, std::size_t branch) const {
        double sum = 0.0;
        for (const auto& [k, sign] : one.members)
            sum += sums.squares[branch * modes_ + k];
        return sum / (sums.displacements * static_cast<double>(one.members.size()) * beads_ * beads_);
    }

    Layout layout_;
    double step_;
    std::size_t modes_;
    double beads_;
    std::vector<MirrorModes> classes_;
    std::vector<std::array<Guide, 2>> guides_;
};

struct ConstantPair {
    double ElasticNumbers::*number;
    Estimate PhononResult::*estimate;
};
constexpr ConstantPair constants[] = {{&ElasticNumbers::c_Lx, &PhononResult::c_Lx},
                                      {&ElasticNumbers::c_Ly, &PhononResult::c_Ly},
                                      {&ElasticNumbers::c_Ld, &PhononResult::c_Ld},
                                      {&ElasticNumbers::c_Tx, &PhononResult::c_Tx},
                                      {&ElasticNumbers::c_Ty, &PhononResult::c_Ty},
                                      {&ElasticNumbers::c_Td, &PhononResult::c_Td},
                                      {&ElasticNumbers::C11, &PhononResult::C11},
                                      {&ElasticNumbers::C22, &PhononResult::C22},
                                      {&ElasticNumbers::C12, &PhononResult::C12},
                                      {&ElasticNumbers::C66, &PhononResult::C66},
                                      {&ElasticNumbers::bulk, &PhononResult::bulk},
                                      {&ElasticNumbers::mu, &PhononResult::mu},
                                      {&ElasticNumbers::eta, &PhononResult::eta},
                                      {&ElasticNumbers::spread_L, &PhononResult::spread_L},
                                      {&ElasticNumbers::spread_T, &PhononResult::spread_T},
                                      {&ElasticNumbers::drag, &PhononResult::drag},
                                      {&ElasticNumbers::viscosity_L, &PhononResult::viscosity_L},
                                      {&ElasticNumbers::viscosity_T, &PhononResult::viscosity_T}};

Row row_of(const ElasticNumbers& e) {
    Row row;
    for (const ConstantPair& item : constants)
        row.push_back(e.*item.number);
    return row;
}

PhononBranch branch_of(const double* value, const double* error, std::size_t blocks, bool kept_places) {
    const auto estimate = [&](BranchNumber i, bool there = true) {
        return there && std::isfinite(value[i]) ? Estimate{value[i], error[i], blocks} : Estimate{};
    };
    PhononBranch b;
    b.omega = estimate(omega);
    b.gamma = estimate(gamma);
    b.temperature = estimate(temperature);
    b.displacement = estimate(displacement, kept_places);
    b.omega_static = estimate(omega_static, kept_places);
    b.share = value[amplitude] / value[temperature];
    return b;
}

void set_curves(PhononBranch& b, const Row& correlation, double step) {
    for (const double c : correlation)
        b.correlation.push_back(c / correlation[0]);
    b.fitted = oscillator_correlation({b.omega.value, b.gamma.value}, step, correlation.size());
    for (double& f : b.fitted)
        f *= b.share;
}

double temperature_of(const PhononSums& sums) { return sums.block.temperature / sums.block.frames; }

} // namespace

PhononResult reduce(Runs runs) {
    if (runs.empty())
        throw InputError("measure: phonons: no runs");
    for (const PhononAccumulator& run : runs) {
        if (!(run.options() == runs[0].options()) || !(run.layout() == runs[0].layout()))
            throw InputError("measure: phonons: the runs were measured with different options or beds");
        if (run.lags() != runs[0].lags() ||
            std::abs(run.interval() - runs[0].interval()) > 1e-6 * runs[0].interval())
            throw InputError(fmt::format("measure: phonons: frames are {:g} s apart in one run and {:g} s in "
                                         "another: must be the same",
                                         runs[0].interval(), run.interval()));
    }
    const std::vector<PhononSums> blocks = phonon_blocks(runs);
    if (blocks.size() < fewest_blocks)
        throw InputError(fmt::format("measure: phonons: {} blocks of time: errors need at least {}; shorten "
                                     "measure.block or run longer",
                                     blocks.size(), fewest_blocks));
    const PhononSums all = pooled(blocks, blocks.size());
    const Analysis analysis(runs[0], all);
    std::vector<Row> rows, numbers, temperatures;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const PhononSums rest = pooled(blocks, b);
        rows.push_back(analysis.branch_rows(rest));
        temperatures.push_back({temperature_of(rest)});
    }
    const Row row = analysis.branch_rows(all);
    const Row errors = Jackknife{row, rows}.errors();
    for (const Row& rest : rows)
        numbers.push_back(row_of(analysis.constants(rest, errors)));
    const Row number = row_of(analysis.constants(row, errors));
    const Row number_errors = Jackknife{number, numbers}.errors();
    PhononResult result;
    result.step = runs[0].interval();
    result.density = analysis.density();
    result.blocks = blocks.size();
    result.temperature = {temperature_of(all), Jackknife{{}, temperatures}.error(0), blocks.size()};
    for (const PhononAccumulator& run : runs)
        result.frames += run.frames();

    // How far beads are from where they were in the first frame, in the last block of each run.
    double squares = 0.0;
    for (const PhononAccumulator& run : runs) {
        const auto last = std::ranges::find_if(run.blocks().rbegin(), run.blocks().rend(),
                                               [](const auto& b) { return b.displacements > 0.0; });
        if (last != run.blocks().rend())
            squares = std::max(squares, last->travel / last->displacements);
    }
    const Layout& layout = runs[0].layout();
    const double area = layout.box.area() / static_cast<double>(layout.beads);
    result.travel = std::sqrt(squares);
    result.kept_places = result.travel < 0.5 * std::sqrt(2.0 / std::sqrt(3.0) * area);
    for (std::size_t i = 0; i < analysis.classes().size(); ++i) {
        const MirrorModes& modes = analysis.classes()[i];
        PhononMode mode{modes.m, modes.n, analysis.qx(modes), analysis.qy(modes), analysis.angle(all, modes),
                        {},      {}};
        const std::size_t at = 2 * i * branch_numbers;
        const CurrentCorrelations c = analysis.branches(all, modes);
        mode.longitudinal = branch_of(&row[at], &errors[at], result.blocks, result.kept_places);
        mode.transverse = branch_of(&row[at + branch_numbers], &errors[at + branch_numbers], result.blocks,
                                    result.kept_places);
        set_curves(mode.longitudinal, c.LL, result.step);
        set_curves(mode.transverse, c.TT, result.step);
        result.modes.push_back(std::move(mode));
    }
    for (std::size_t i = 0; i < number.size(); ++i)
        if (std::isfinite(number[i]))
            result.*constants[i].estimate = {number[i], number_errors[i], blocks.size()};
    return result;
}

namespace {

constexpr int longest_wave_used = 2; // waves along a side: where omega is still proportional to q
constexpr std::size_t directions = 91;

using Numbers = std::vector<ModeNumbers>;

/// c of omega = c q over the modes that `holds` names.
template<class Holds>
double speed(const Numbers& modes, double ModeNumbers::*omega, double ModeNumbers::*weight,
             const Holds& holds) {
    double products = 0.0, squares = 0.0;
    for (const ModeNumbers& k : modes) {
        const double q = std::hypot(k.qx, k.qy);
        if (!holds(k) || std::max(k.m, k.n) > longest_wave_used || !std::isfinite(k.*omega * k.*weight))
            continue;
        products += k.*weight * q * k.*omega;
        squares += k.*weight * q * q;
    }
    return squares > 0.0 ? products / squares : NAN;
}

/// gamma = drag + nu_L q^2, drag + nu_T q^2: weighted least squares over all modes.
void set_drag(ElasticNumbers& out, const Numbers& modes) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto add = [&](const Eigen::Vector3d& row, double gamma, double weight) {
        if (!std::isfinite(gamma * weight))
            return;
        normal += weight * row * row.transpose();
        right += weight * gamma * row;
    };
    double scale = 0.0; // of q^2, so that the columns are alike
    for (const ModeNumbers& k : modes)
        scale = std::max(scale, k.qx * k.qx + k.qy * k.qy);
    for (const ModeNumbers& k : modes) {
        const double q2 = (k.qx * k.qx + k.qy * k.qy) / scale;
        add({1.0, q2, 0.0}, k.gamma_L, k.weight_gamma_L);
        add({1.0, 0.0, q2}, k.gamma_T, k.weight_gamma_T);
    }
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d found =
        solver.isInvertible() ? Eigen::Vector3d(solver.solve(right)) : Eigen::Vector3d::Constant(NAN);
    out.drag = found[0];
    out.viscosity_L = found[1] / scale;
    out.viscosity_T = found[2] / scale;
}

} // namespace

WaveModuli wave_moduli(double C11, double C22, double C12, double C66, double angle) {
    const double cx = std::cos(angle), cy = std::sin(angle);
    const double xx = C11 * cx * cx + C66 * cy * cy, yy = C66 * cx * cx + C22 * cy * cy;
    const double half = 0.5 * (xx + yy), root = std::hypot(0.5 * (xx - yy), (C12 + C66) * cx * cy);
    return {half + root, half - root};
}

ElasticNumbers elastic_numbers(const Numbers& modes, double density) {
    const auto along_x = [](const ModeNumbers& k) { return k.n == 0; };
    const auto along_y = [](const ModeNumbers& k) { return k.m == 0; };
    const auto on_axis = [](const ModeNumbers& k) { return k.m == 0 || k.n == 0; };
    const auto diagonal = [](const ModeNumbers& k) { return k.m == k.n; };
    const auto L = &ModeNumbers::omega_L, wL = &ModeNumbers::weight_omega_L;
    const auto T = &ModeNumbers::omega_T, wT = &ModeNumbers::weight_omega_T;
    const auto modulus = [&](double c) { return density * c * c; };
    ElasticNumbers e{};
    e.c_Lx = speed(modes, L, wL, along_x);
    e.c_Ly = speed(modes, L, wL, along_y);
    e.c_Ld = speed(modes, L, wL, diagonal);
    e.c_Tx = speed(modes, T, wT, along_x);
    e.c_Ty = speed(modes, T, wT, along_y);
    e.c_Td = speed(modes, T, wT, diagonal);
    e.C11 = modulus(e.c_Lx);
    e.C22 = modulus(e.c_Ly);
    e.C66 = modulus(speed(modes, T, wT, on_axis));
    const auto oblique = std::ranges::find_if(modes, diagonal);
    const double q = oblique == modes.end() ? 0.0 : std::hypot(oblique->qx, oblique->qy);
    e.C12 = NAN;
    if (q > 0.0) {
        // Christoffel's equation for C12 from one wave off the axes; the root that a stable medium near
        // isotropy has.
        const double cx = oblique->qx / q, cy = oblique->qy / q, diagonal_modulus = modulus(e.c_Ld);
        const double xx = e.C11 * cx * cx + e.C66 * cy * cy, yy = e.C66 * cx * cx + e.C22 * cy * cy;
        e.C12 = std::sqrt((diagonal_modulus - xx) * (diagonal_modulus - yy)) / (cx * cy) - e.C66;
    }
    e.bulk = (e.C11 + e.C22 + 2.0 * e.C12) / 4.0;
    e.mu = (e.C11 + e.C22 - 2.0 * e.C12 + 4.0 * e.C66) / 8.0;
    e.eta = e.bulk / e.mu;
    double low_L = INFINITY, high_L = -INFINITY, low_T = INFINITY, high_T = -INFINITY;
    for (std::size_t i = 0; i < directions; ++i) {
        const double angle = 0.5 * std::numbers::pi * static_cast<double>(i) / (directions - 1);
        const WaveModuli moduli = wave_moduli(e.C11, e.C22, e.C12, e.C66, angle);
        low_L = std::min(low_L, moduli.longitudinal);
        high_L = std::max(high_L, moduli.longitudinal);
        low_T = std::min(low_T, moduli.transverse);
        high_T = std::max(high_T, moduli.transverse);
    }
    e.spread_L = std::isfinite(e.mu) ? (high_L - low_L) / (e.bulk + e.mu) : NAN;
    e.spread_T = std::isfinite(e.mu) ? (high_T - low_T) / e.mu : NAN;
    set_drag(e, modes);
    return e;
}

} // namespace rodwake::measure
