#include "nist.hpp"

#include "dual.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace {

using Values = std::vector<Dual>;
using Predictors = std::vector<long double>;
/// Model at parameters b and predictors x (x[0] = x or x1).
using Model = std::function<Dual(const Values& b, const Predictors& x)>;

constexpr long double pi = std::numbers::pi_v<long double>;

Dual saturating(const Values& b, const Predictors& x) { return b[0] * (1.0L - exp(-b[1] * x[0])); }

Dual three_exponentials(const Values& b, const Predictors& x) {
    return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-b[3] * x[0]) + b[4] * exp(-b[5] * x[0]);
}

Dual two_peaks(const Values& b, const Predictors& x) {
    return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-square(x[0] - b[3]) / square(b[4])) +
           b[5] * exp(-square(x[0] - b[6]) / square(b[7]));
}

Dual decay_over_line(const Values& b, const Predictors& x) {
    return exp(-b[0] * x[0]) / (b[1] + b[2] * x[0]);
}

Dual cubics(const Values& b, const Predictors& v) {
    const long double x = v[0];
    return (b[0] + b[1] * x + b[2] * (x * x) + b[3] * (x * x * x)) /
           (1.0L + b[4] * x + b[5] * (x * x) + b[6] * (x * x * x));
}

Dual quadratics(const Values& b, const Predictors& v) {
    const long double x = v[0];
    return (b[0] + b[1] * x + b[2] * (x * x)) / (1.0L + b[3] * x + b[4] * (x * x));
}

Dual oscillations(const Values& b, const Predictors& x) {
    const Dual year = 2.0L * pi * x[0] / 12.0L, first = Dual(2.0L * pi * x[0]) / b[3],
               second = Dual(2.0L * pi * x[0]) / b[6];
    return b[0] + b[1] * cos(year) + b[2] * sin(year) + b[4] * cos(first) + b[5] * sin(first) +
           b[7] * cos(second) + b[8] * sin(second);
}

const std::map<std::string, Model>& models() {
    using X = const Predictors&;
    static const std::map<std::string, Model> all{
        {"Bennett5", [](const Values& b, X x) { return b[0] * pow(b[1] + x[0], -1.0L / b[2]); }},
        {"BoxBOD", saturating},
        {"Chwirut1", decay_over_line},
        {"Chwirut2", decay_over_line},
        {"DanWood", [](const Values& b, X x) { return b[0] * pow(x[0], b[1]); }},
        {"ENSO", oscillations},
        {"Eckerle4",
         [](const Values& b, X x) { return b[0] / b[1] * exp(-0.5L * square((x[0] - b[2]) / b[1])); }},
        {"Gauss1", two_peaks},
        {"Gauss2", two_peaks},
        {"Gauss3", two_peaks},
        {"Hahn1", cubics},
        {"Kirby2", quadratics},
        {"Lanczos1", three_exponentials},
        {"Lanczos2", three_exponentials},
        {"Lanczos3", three_exponentials},
        {"MGH09",
         [](const Values& b, X v) {
             const long double x = v[0];
             return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
         }},
        {"MGH10", [](const Values& b, X x) { return b[0] * exp(b[1] / (x[0] + b[2])); }},
        {"MGH17",
         [](const Values& b, X x) { return b[0] + b[1] * exp(-b[3] * x[0]) + b[2] * exp(-b[4] * x[0]); }},
        {"Misra1a", saturating},
        {"Misra1b",
         [](const Values& b, X x) { return b[0] * (1.0L - reciprocal(square(1.0L + b[1] * x[0] / 2.0L))); }},
        {"Misra1c",
         [](const Values& b, X x) { return b[0] * (1.0L - pow(1.0L + 2.0L * b[1] * x[0], -0.5L)); }},
        {"Misra1d", [](const Values& b, X x) { return b[0] * b[1] * x[0] / (1.0L + b[1] * x[0]); }},
        {"Nelson", [](const Values& b, X x) { return b[0] - b[1] * x[0] * exp(-b[2] * x[1]); }},
        {"Rat42", [](const Values& b, X x) { return b[0] / (1.0L + exp(b[1] - b[2] * x[0])); }},
        {"Rat43",
         [](const Values& b, X x) { return b[0] / pow(1.0L + exp(b[1] - b[2] * x[0]), 1.0L / b[3]); }},
        {"Roszman1",
         [](const Values& b, X x) { return b[0] - b[1] * x[0] - atan(b[2] / (x[0] - b[3])) / pi; }},
        {"Thurber", cubics}};
    return all;
}

template<class Number = double>
std::vector<Number> numbers_in(const std::string& line) {
    std::istringstream stream(line);
    std::vector<Number> numbers;
    for (Number x; stream >> x;)
        numbers.push_back(x);
    return numbers;
}

/// "b1 = start1 start2 certified deviation"
void read_parameter(NistProblem& nist, const std::string& line) {
    const auto numbers = numbers_in(line.substr(line.find('=') + 1));
    if (numbers.size() != 4)
        throw std::runtime_error(nist.name + ": not four numbers in: " + line);
    nist.starts[0].push_back(numbers[0]);
    nist.starts[1].push_back(numbers[1]);
    // The file misprints b1 of Roszman1, 1.20196866396E-0 for 2.0196866396E-01: a test shows which is right.
    const bool misprint = nist.name == "Roszman1" && nist.certified.empty() && numbers[2] == 1.20196866396;
    nist.certified.push_back(misprint ? 2.0196866396e-1 : numbers[2]);
    nist.deviation.push_back(numbers[3]);
}

double after_colon(const std::string& line) { return numbers_in(line.substr(line.find(':') + 1)).at(0); }

} // namespace

std::vector<std::string> nist_names() {
    std::vector<std::string> names;
    for (const auto& [name, model] : models())
        names.push_back(name);
    return names;
}

NistProblem parse_nist(const std::string& name, const std::string& text) {
    NistProblem nist;
    nist.name = name;
    std::istringstream lines(text);
    double observations = 0.0;
    bool data = false;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t first = line.find_first_not_of(" \r\t");
        if (data && first != std::string::npos)
            nist.rows.push_back(numbers_in<long double>(line));
        else if (first != std::string::npos && line[first] == 'b' && line.find(" =") < first + 5)
            read_parameter(nist, line);
        else if (line.starts_with("Residual Sum of Squares:"))
            nist.sum_of_squares = after_colon(line);
        else if (line.starts_with("Number of Observations:"))
            observations = after_colon(line);
        data = data || (observations > 0.0 && line.starts_with("Data:"));
    }
    if (nist.certified.empty() || static_cast<double>(nist.rows.size()) != observations ||
        std::ranges::any_of(nist.rows, [&](const auto& row) { return row.size() != nist.rows[0].size(); }))
        throw std::runtime_error(name + ": not the number of parameters or data its header says");
    return nist;
}

NistProblem read_nist(const std::string& name) {
    std::ifstream file((RODWAKE_TEST_DATA "/nist_strd/" + name).append(".dat"));
    std::stringstream text;
    text << file.rdbuf();
    return parse_nist(name, text.str());
}

rodwake::fitting::Problem nist_problem(const NistProblem& nist, std::size_t start) {
    rodwake::fitting::Problem problem;
    for (std::size_t k = 0; k < nist.certified.size(); ++k) {
        rodwake::fitting::Parameter p;
        p.name = "b" + std::to_string(k + 1);
        p.start = nist.starts[start][k];
        problem.parameters.push_back(p);
    }
    problem.residuals = nist.rows.size();
    problem.sigma_known = false;
    problem.evaluate = [nist, model = models().at(nist.name)](auto p, auto r, Eigen::MatrixXd* jacobian) {
        Values b;
        for (std::size_t k = 0; k < p.size(); ++k)
            b.push_back(Dual::variable(p[k], k));
        for (std::size_t i = 0; i < nist.rows.size(); ++i) {
            const Predictors x(nist.rows[i].begin() + 1, nist.rows[i].end());
            const long double y = nist.name == "Nelson" ? std::log(nist.rows[i][0]) : nist.rows[i][0];
            const Dual residual = model(b, x) - y;
            r[static_cast<Eigen::Index>(i)] = static_cast<double>(residual.value);
            for (std::size_t k = 0; jacobian && k < p.size(); ++k)
                (*jacobian)(i, k) = static_cast<double>(residual.slope[k]);
        }
    };
    return problem;
}

double digits(double value, double certified) {
    const double error = std::abs(value - certified) / std::abs(certified);
    return std::isfinite(error) ? std::clamp(-std::log10(std::max(error, 1e-11)), 0.0, 11.0) : 0.0;
}
