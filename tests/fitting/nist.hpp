#pragma once
// The nonlinear regression problems of NIST's Statistical Reference Datasets, read from NIST's own files.

#include "rodwake/fitting/problem.hpp"

#include <array>
#include <string>
#include <vector>

struct NistProblem {
    std::string name;
    std::array<std::vector<double>, 2> starts;
    std::vector<double> certified, deviation; ///< parameters and their standard deviations
    double sum_of_squares = 0.0;
    std::vector<std::vector<long double>>
        rows; ///< y, x or y, x1, x2; Lanczos1 fits to 13 digits, which doubles spoil
};

/// Names of the 27 problems.
std::vector<std::string> nist_names();

/// Throws std::runtime_error for a file that is not as its own header says.
NistProblem read_nist(const std::string& name);
NistProblem parse_nist(const std::string& name, const std::string& text);

/// Residuals model - y with exact derivatives, evaluated in extended precision; sigmas unknown. `start`: 0
/// or 1.
rodwake::fitting::Problem nist_problem(const NistProblem& nist, std::size_t start);

/// NIST's measure: correct digits, -log10 |value - certified|/|certified|, at most 11 (what is certified).
double digits(double value, double certified);
