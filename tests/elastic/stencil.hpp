#pragma once
// Derivatives of a function of one variable by differences.

namespace rodwake::oracle {

/// f'(0) by the eight-point central stencil. Error: truncation h^8 f^(9)/630, rounding 2 eps |f|/h.
template<class Function>
double difference_quotient(Function f, double h) {
    constexpr double weight[] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
    double sum = 0.0;
    for (int k = 1; k <= 4; ++k)
        sum += weight[k - 1] * (f(k * h) - f(-k * h));
    return sum / h;
}

} // namespace rodwake::oracle
