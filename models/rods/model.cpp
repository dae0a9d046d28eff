#include "rodwake/rods/model.hpp"

#include "interaction.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace rodwake::rods {

namespace {

/// Sources and sums of a right-hand side: of few rods, as most are, without a call for memory.
class Wakes {
public:
    explicit Wakes(integrate::State y) {
        const std::size_t rods = y.size() / 3;
        if (rods > few) {
            many_rods_.resize(rods);
            many_sums_.resize(rods);
        }
        for (std::size_t a = 0; a < rods; ++a)
            rods_of(rods)[a] = {y[3 * a], y[3 * a + 1], y[3 * a + 2]};
    }

    std::span<elastic::Source> rods_of(std::size_t rods) {
        return {rods > few ? many_rods_.data() : few_rods_.data(), rods};
    }
    std::span<elastic::FieldValues> sums_of(std::size_t rods) {
        return {rods > few ? many_sums_.data() : few_sums_.data(), rods};
    }

private:
    static constexpr std::size_t few = 2;
    std::array<elastic::Source, few> few_rods_;
    std::array<elastic::FieldValues, few> few_sums_;
    std::vector<elastic::Source> many_rods_;
    std::vector<elastic::FieldValues> many_sums_;
};

} // namespace

RodModel::RodModel(std::shared_ptr<const elastic::WakeField> field, const Couplings& couplings,
                   std::size_t rods, const Rows& rows, BodyForces bodies)
    : couplings_(couplings), rods_(rods), rows_(rows), bodies_(std::move(bodies)) {
    if (field && couplings.any() && (rods > 1 || field->box()))
        field_ = std::move(field);
}

void RodModel::rhs(integrate::State y, std::span<double> ydot) const {
    for (std::size_t a = 0; a < rods_; ++a) {
        const Direction n = direction(y, a);
        ydot[3 * a] = n.cosine;
        ydot[3 * a + 1] = n.sine;
        ydot[3 * a + 2] = 0.0;
    }
    if (field_) {
        Wakes wakes(y);
        const auto sums = wakes.sums_of(rods_);
        field_->mutual(wakes.rods_of(rods_), request_of(couplings_, false), sums);
        for (std::size_t a = 0; a < rods_; ++a)
            ydot[3 * a + 2] = turning_rate(sums[a], couplings_, {ydot[3 * a], ydot[3 * a + 1]});
    }
    if (rows_.any())
        for (std::size_t a = 0; a < rods_; ++a)
            ydot[3 * a + 2] += rows_.rate(y[3 * a + 2]);
    bodies_.add_rates(y, ydot);
}

void RodModel::wakes(integrate::State y, std::span<elastic::FieldValues> sums) const {
    if (field_)
        field_->mutual(Wakes(y).rods_of(rods_), request_of(couplings_, false), sums);
}

void RodModel::linearise(integrate::State y, std::span<double> ydot,
                         Eigen::Ref<Eigen::MatrixXd> by_state) const {
    const bool shared = field_ && !field_->box(); // of images only the sum is known
    if (!shared)
        rhs(y, ydot);
    by_state.setZero();
    fill_jacobian(y, by_state, shared ? ydot : std::span<double>{});
    for (std::size_t a = 0; shared && a < rods_; ++a) {
        ydot[3 * a] = by_state(static_cast<Eigen::Index>(3 * a + 1), static_cast<Eigen::Index>(3 * a + 2));
        ydot[3 * a + 1] = -by_state(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * a + 2));
        if (rows_.any())
            ydot[3 * a + 2] += rows_.rate(y[3 * a + 2]);
    }
    if (shared)
        bodies_.add_rates(y, ydot);
    bodies_.add_jacobian(y, by_state);
}

void RodModel::jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian) const {
    jacobian.setZero();
    fill_jacobian(y, jacobian, {});
    bodies_.add_jacobian(y, jacobian);
}

/// To zeros. `rates`: where the headings' rates in the wakes go too, unless empty.
void RodModel::fill_jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian,
                             std::span<double> rates) const {
    std::fill(rates.begin(), rates.end(), 0.0);
    for (std::size_t a = 0; a < rods_; ++a) {
        const Direction na = direction(y, a);
        const auto row = static_cast<Eigen::Index>(3 * a);
        jacobian(row, row + 2) = -na.sine;
        jacobian(row + 1, row + 2) = na.cosine;
        if (rows_.any())
            jacobian(row + 2, row + 2) = rows_.rate_by_heading(y[3 * a + 2]);
    }
    if (!field_)
        return;

    // The wake of rod b adds to the rows of the others, and that of its images to its own.
    const bool images = field_->box().has_value();
    const elastic::FieldRequest values = request_of(couplings_, false);
    for (std::size_t b = 0; b < rods_; ++b) {
        const Direction nb = direction(y, b);
        const auto column = static_cast<Eigen::Index>(3 * b);
        const auto wake = field_->wake(y[3 * b + 2]);
        if (images)
            jacobian(column + 2, column + 2) +=
                turning_rate(wake->own_place_by_heading(values), couplings_, {1.0, 0.0});
        for (std::size_t a = 0; a < rods_; ++a) {
            if (a == b)
                continue;
            const View at = view(y, a, b, direction(y, a), nb);
            const auto row = static_cast<Eigen::Index>(3 * a);
            const auto rate = turning_rate_derivatives(wake->at(at.x, at.y, request_of(couplings_, true)),
                                                       couplings_, at.heading);
            if (!rates.empty())
                rates[3 * a + 2] += rate.value;
            // The gradient in b's frame, turned to the lab; moving a one way is moving b the other.
            const double by_x = nb.cosine * rate.by_x - nb.sine * rate.by_y;
            const double by_y = nb.sine * rate.by_x + nb.cosine * rate.by_y;
            jacobian(row + 2, row) += by_x;
            jacobian(row + 2, row + 1) += by_y;
            jacobian(row + 2, row + 2) += rate.by_phi;
            jacobian(row + 2, column) -= by_x;
            jacobian(row + 2, column + 1) -= by_y;
            // Turning b carries its frame along: d(x, y)/d theta_b = (y, -x), d phi/d theta_b = -1; and it
            // turns b against the box.
            jacobian(row + 2, column + 2) += at.y * rate.by_x - at.x * rate.by_y - rate.by_phi;
            if (images)
                jacobian(row + 2, column + 2) +=
                    turning_rate(wake->heading_derivative(at.x, at.y, values), couplings_, at.heading);
        }
    }
}

std::string RodModel::component_name(std::size_t component) {
    static constexpr std::array names = {"x", "y", "theta"};
    return "rods[" + std::to_string(component / 3) + "]." + names[component % 3];
}

std::vector<double> to_state(std::span<const Pose> rods) {
    std::vector<double> y;
    y.reserve(3 * rods.size());
    for (const Pose& rod : rods)
        y.insert(y.end(), {rod.x, rod.y, rod.heading});
    return y;
}

Pose pose(integrate::State y, std::size_t rod) { return {y[3 * rod], y[3 * rod + 1], y[3 * rod + 2]}; }

std::string coupling_names(bool polar) {
    std::string names;
    for (const Coupling& coupling : coupling_list)
        if (coupling.polar == polar)
            names += (names.empty() ? "" : ", ") + std::string(coupling.name);
    return names;
}

Couplings from_divergence_basis(const Couplings& of_divergence) {
    const auto [kappa, gamma1, gamma2] = of_divergence;
    return {kappa, 0.5 * gamma1, gamma2 + 0.5 * gamma1};
}

namespace {

using elastic::SymmetricTensor;
using elastic::Vector;

/// z.[n x eps.n] = eps_xy cos 2phi + (eps_yy - eps_xx)/2 sin 2phi: only the traceless part turns a rod.
double axis_torque(const SymmetricTensor& e, RelativeHeading n) {
    const double cos2 = n.cosine * n.cosine - n.sine * n.sine, sin2 = 2.0 * n.cosine * n.sine;
    return e.xy * cos2 + 0.5 * (e.yy - e.xx) * sin2;
}

/// z.[n x v]
double vector_torque(const Vector& v, RelativeHeading n) { return n.cosine * v.y - n.sine * v.x; }

Vector polar_vector(const Couplings& c, const Vector& laplacian, const Vector& gradient) {
    const auto& [kappa, gamma1, gamma2] = c;
    return {gamma1 * laplacian.x + gamma2 * gradient.x, gamma1 * laplacian.y + gamma2 * gradient.y};
}

} // namespace

elastic::FieldRequest request_of(const Couplings& couplings, bool gradients) {
    return {.strain = couplings.apolar(), .polar = couplings.polar(), .gradients = gradients};
}

double turning_rate(const elastic::FieldValues& f, const Couplings& c, RelativeHeading n) {
    const auto& [kappa, gamma1, gamma2] = c; // the polar ones: polar_vector
    double rate = 0.0;
    if (c.apolar())
        rate += kappa * axis_torque(f.strain, n);
    if (c.polar())
        rate += vector_torque(polar_vector(c, f.laplacian, f.gradient_of_trace), n);
    return rate;
}

Vector drive(const elastic::FieldValues& f, const Couplings& c, Vector n) {
    const auto& [kappa, gamma1, gamma2] = c;
    Vector h{0.0, 0.0};
    if (c.apolar())
        h = {kappa * (f.strain.xx * n.x + f.strain.xy * n.y),
             kappa * (f.strain.xy * n.x + f.strain.yy * n.y)};
    if (c.polar()) {
        const Vector polar = polar_vector(c, f.laplacian, f.gradient_of_trace);
        h = {h.x + polar.x, h.y + polar.y};
    }
    return h;
}

TurningRate turning_rate_derivatives(const elastic::FieldValues& f, const Couplings& c, RelativeHeading n) {
    const auto& [kappa, gamma1, gamma2] = c;
    TurningRate rate{turning_rate(f, c, n), 0.0, 0.0, 0.0};
    if (c.apolar()) {
        rate.by_x += kappa * axis_torque(f.strain_x, n);
        rate.by_y += kappa * axis_torque(f.strain_y, n);
        const double cos2 = n.cosine * n.cosine - n.sine * n.sine, sin2 = 2.0 * n.cosine * n.sine;
        rate.by_phi += kappa * ((f.strain.yy - f.strain.xx) * cos2 - 2.0 * f.strain.xy * sin2);
    }
    if (c.polar()) {
        rate.by_x += vector_torque(polar_vector(c, f.laplacian_x, f.gradient_of_trace_x), n);
        rate.by_y += vector_torque(polar_vector(c, f.laplacian_y, f.gradient_of_trace_y), n);
        const Vector v = polar_vector(c, f.laplacian, f.gradient_of_trace);
        rate.by_phi += -n.sine * v.y - n.cosine * v.x;
    }
    return rate;
}

} // namespace rodwake::rods
