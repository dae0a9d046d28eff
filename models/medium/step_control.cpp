#include "step_control.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::medium {

// A polynomial f of degree 5 is f(s) = sum of value_k f(k - 1) + rate_k f'(k - 1), k = 0, 1, 2.

std::vector<double> DoubleStep::at(double when) const {
    const double s = (when - time) / half - 1.0;
    const double s2 = s * s, inner = 1.0 - s2, left = s - 1.0, right = s + 1.0;
    const double value[] = {0.25 * s2 * left * left * (4.0 + 3.0 * s), inner * inner,
                            0.25 * s2 * right * right * (4.0 - 3.0 * s)};
    const double rate[] = {0.25 * s2 * left * left * right, s * inner * inner,
                           0.25 * s2 * right * right * left};
    std::vector<double> y(poses[0].size());
    for (std::size_t i = 0; i < y.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            y[i] += value[k] * poses[k][i] + rate[k] * half * rates[k][i];
    return y;
}

std::vector<double> DoubleStep::rates_at(double when) const {
    const double s = (when - time) / half - 1.0, s2 = s * s, s3 = s2 * s, s4 = s2 * s2;
    const double value[] = {2.0 * s - 3.75 * s2 - 2.0 * s3 + 3.75 * s4, -4.0 * s + 4.0 * s3,
                            2.0 * s + 3.75 * s2 - 2.0 * s3 - 3.75 * s4};
    const double rate[] = {0.25 * (2.0 * s - 3.0 * s2 - 4.0 * s3 + 5.0 * s4), 1.0 - 6.0 * s2 + 5.0 * s4,
                           0.25 * (-2.0 * s - 3.0 * s2 + 4.0 * s3 + 5.0 * s4)};
    std::vector<double> y(poses[0].size());
    for (std::size_t i = 0; i < y.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            y[i] += value[k] * poses[k][i] / half + rate[k] * rates[k][i];
    return y;
}

void DoubleStep::add_own_turn(double when, std::vector<double>& turn) const {
    const double s = (when - time) / half - 1.0; // from -1 to 1
    for (std::size_t a = 0; a < own[0].size(); ++a)
        turn[a] += half * (own[1][a] * (s + 1.0) + 0.25 * (own[2][a] - own[0][a]) * (s * s - 1.0) +
                           (own[0][a] - 2.0 * own[1][a] + own[2][a]) / 6.0 * (s * s * s + 1.0));
}

StepControl::StepControl(CoupledStep& method, Tolerance tolerance, Coupled state, double time, double step)
    : method_(method), tolerance_(tolerance), state_(std::move(state)), rates_(state_.poses.size()),
      middle_rates_(rates_.size()), field_error_(state_.fields.size()), rate_error_(rates_.size()),
      time_(time), step_(step) {
    method_.rates(state_.poses, state_.fields, rates_);
    own_ = method_.own_turning(state_);
}

void StepControl::accept(double step, double limit) {
    last_.time = time_;
    last_.half = 0.5 * step;
    last_.poses[0] = state_.poses;
    last_.rates[0] = rates_;
    for (std::size_t i = 0; i < rates_.size(); ++i) {
        const double correction = (end_.poses[i] - whole_.poses[i]) / 15.0;
        end_.poses[i] += correction;
        middle_.poses[i] += 0.5 * correction; // one of two equal local errors
    }
    for (std::size_t i = 0; i < field_error_.size(); ++i)
        end_.fields[i] += field_error_[i];
    last_.poses[1] = middle_.poses;
    last_.rates[1] = middle_rates_;
    last_.own = {own_, method_.own_turning(middle_), {}};
    std::swap(state_, end_);
    method_.rates(state_.poses, state_.fields, rates_);
    own_ = last_.own[2] = method_.own_turning(state_);
    ++evaluations_;
    last_.poses[2] = state_.poses;
    last_.rates[2] = rates_;
    time_ = step == limit - time_ ? limit : time_ + step;
}

std::span<const double> StepControl::fields_at(double when) {
    if (when == time_)
        return state_.fields;
    const std::size_t part = when < last_.time + last_.half ? 0 : 1;
    const Coupled& from = part == 0 ? end_ : middle_;
    const double step = when - (part == 0 ? last_.time : last_.time + last_.half);
    if (!(step > 0.0))
        return from.fields;
    method_.take(from, last_.rates[part], step, whole_);
    return whole_.fields;
}

bool StepControl::advance(double longest, double limit, long& failures) {
    constexpr double safety = 0.9, least = 0.2, most = 3.0, order = 5.0;
    for (;;) {
        const double wanted = std::min(step_, longest), left = limit - time_;
        const double step = left <= wanted        ? left
                            : left < 2.0 * wanted ? 0.5 * left
                                                  : wanted; // no crumb at the end
        if (!(step > 1e-13 * std::max(1.0, std::abs(time_))))
            return false;

        // The whole step, and both halves.
        method_.take(state_, rates_, step, whole_);
        method_.take(state_, rates_, 0.5 * step, middle_);
        method_.rates(middle_.poses, middle_.fields, middle_rates_);
        method_.take(middle_, middle_rates_, 0.5 * step, end_);

        // The error over the tolerance; above 1 the step is too long.
        for (std::size_t i = 0; i < field_error_.size(); ++i)
            field_error_[i] = (end_.fields[i] - whole_.fields[i]) / 15.0;
        method_.free_rates(end_.poses, field_error_, rate_error_); // linear in the fields
        evaluations_ += 11;
        double sum = 0.0;
        for (std::size_t i = 0; i < rates_.size(); ++i) {
            const double allowed = tolerance_.rtol * std::min(std::abs(end_.poses[i]), 1.0) + tolerance_.atol;
            const double pose = (end_.poses[i] - whole_.poses[i]) / 15.0,
                         turning = i % 3 == 2 ? rate_error_[i] : 0.0;
            sum += (pose * pose + turning * turning) / (allowed * allowed);
        }
        const double e = std::sqrt(sum);
        const double factor = e > 0.0 ? std::clamp(safety * std::pow(e, -1.0 / order), least, most) : most;
        step_ = std::isfinite(e) ? step * factor : least * step;
        if (e <= 1.0) {
            accept(step, limit);
            return true;
        }
        ++failures;
    }
}

} // namespace rodwake::medium
