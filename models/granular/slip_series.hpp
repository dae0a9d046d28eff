#pragma once
// One step of a curved slip path as a Taylor series. With dp = r dtau the path is free of the singularity at
// r = 0 and, in v_t = r s, almost linear (contact terms of slip_path.hpp):
//
//   dv_t/dtau = r q - mu A v_t,   r^2 = v_t.v_t,   dp/dtau = r,   dP_t/dtau = -mu v_t,
//   dv_z/dtau = r - mu q.v_t,     dW/dtau = r v_z
//
// so one Cauchy product an order gives all of v_t, r, p, P_t and v_z, and one more gives W. Coefficients are
// in u = tau/(length of the step), 0 <= u <= 1, and in units of the speed at its start.

#include "slip_path.hpp"

#include <array>

namespace rodwake::granular {

class SlipSeries {
public:
    static constexpr int order = 20;
    /// Of W: a product of two series of exponential kind falls off later than they do.
    static constexpr int work_order = 30;

    SlipSeries(const ContactTerms& contact, const ImpactProgress& from);

    /// First event of the step, or its end.
    struct Stop {
        double u = 1.0;
        bool turned = false; ///< v_z rises through 0
        bool ended = false;  ///< the impact is over
    };
    Stop stop() const;

    /// The state at u; `stop` as returned.
    void advance(ImpactProgress& at, const Stop& stop) const;

private:
    using Coefficients = std::array<double, order + 1>;

    void expand();
    double step_length() const;
    void scale_to(double length);
    void integrate_normal();
    void integrate_work();
    int cuts(std::array<double, 6>& u) const;
    Stop stop_between(double low, double high) const;

    const ContactTerms& contact_;
    const ImpactProgress& from_;
    Coefficients x_, y_, r_;               ///< v_t and r
    Coefficients v_;                       ///< v_z
    std::array<double, work_order + 1> w_; ///< W - W(0)
    double impulse_;                       ///< p of the step, were r constant
    double wanted_;
};

} // namespace rodwake::granular
