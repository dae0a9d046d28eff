// By what factor data exceed a prediction.

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/wake.hpp"

#include <cmath>

namespace rodwake::fitting {

Excess excess(const Profile& data, std::span<const double> model, const Eigen::MatrixXd* model_root) {
    const auto n = static_cast<Eigen::Index>(data.value.size());
    if (static_cast<Eigen::Index>(model.size()) != n)
        throw InputError(data.name + ": data and prediction differ in number");
    const Eigen::Map<const Eigen::VectorXd> d(data.value.data(), n), m(model.data(), n);
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(n);
    const double values = data.independent * static_cast<double>(n);
    if (!data.sigma.empty())
        weight = Eigen::Map<const Eigen::VectorXd>(data.sigma.data(), n).array().square().inverse();
    weight *= data.independent;
    const double norm = weight.dot(m.cwiseAbs2());
    Excess out;
    out.points = data.value.size();
    out.chi2 = weight.dot((d - m).cwiseAbs2());
    if (!(norm > 0.0))
        throw InputError(data.name + ": the prediction is zero everywhere, so no factor can be told");
    out.scale = weight.dot(m.cwiseProduct(d)) / norm;
    const double scatter = weight.dot((d - out.scale * m).cwiseAbs2()) / std::max(values - 1.0, 1.0);
    // Where the shape differs, or sigma is unknown, the scatter about the scaled model tells more than sigma.
    double variance = (data.sigma.empty() ? scatter : std::max(scatter, 1.0)) / norm;
    if (model_root) {
        const Eigen::VectorXd by_model = weight.cwiseProduct(d - 2.0 * out.scale * m) / norm;
        variance += (model_root->transpose() * by_model).squaredNorm();
    }
    out.stderr_ = std::sqrt(variance);
    return out;
}

} // namespace rodwake::fitting
