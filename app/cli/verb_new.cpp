// rodwake new: a small scene to begin with, made from the answers to three questions.

#include "definition.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <unistd.h>

namespace rodwake::cli {

namespace {

using Answers = std::map<std::string, std::string>;

constexpr const char* theory = R"(schema = 1
title = "{}"
units = "reduced"            # lengths in f/mu, times in f/(mu v0)

[medium]                     # the elastic continuum; leave it out and rods walk straight
eta = 1.0                    # bulk over shear modulus
alpha = 1.0                  # (f/mu)/xi: how strongly the substrate screens

[coupling]                   # how a rod turns in another's wake
kappa = {}                   # its axis turns to the extensional axis of the strain
)";

constexpr const char* rod = R"(
[[rods]]
position = [0.0, {:.1f}]
heading = "{} deg"
)";

constexpr const char* rods_run = R"(
[rods_run]
t_end = 60.0
output_interval = 0.25       # rows of rods.csv
contact_distance = 0.1       # stop when two rods are this near

[[figures]]
name = "trajectories"
kind = "trajectories"
)";

constexpr const char* scan = R"(
[rods_run]
t_end = 60.0
contact_distance = 0.1       # stop when two rods are this near

[scan]
design = "adaptive"          # refined where the outcome changes
resolution = 128             # cells a side at the finest

[[scan.axes]]
key = "coupling.kappa"
from = {0:g}
to = {1:g}
spacing = "log"
count = 16

[[scan.axes]]
key = "rods.1.position.{2}"
from = {3}
to = {4}
count = 16

[[figures]]
name = "phase_diagram"
kind = "phase_diagram"
)";

constexpr const char* critical = R"(
[rods_run]
t_end = 60.0
contact_distance = 0.1       # stop when two rods are this near

[scan]
design = "critical"          # solves for the values at which the end of an encounter changes
solve_for = "coupling.kappa"
from = 10.0
to = 100.0
spacing = "log"
count = 16                   # values tried first, and as many at random: two changes between two may go unseen
between = ["capture", "escape"]   # or two outcomes, ["contact", "other"], ["any"]
tolerance = 1e-6             # of the value; rods_run.rtol is a hundredth of that
trajectories = 0

[[scan.axes]]                # for each of these
key = "medium.alpha"
from = 0.5
to = 2.0
spacing = "log"
count = 11

[[figures]]
name = "critical_kappa"
kind = "critical_values"
)";

constexpr const char* bed = R"(schema = 1
title = "Rods in a vibrated bed of beads"

[granular]
phi_b = {}                   # area fraction of the beads; a is the bead radius, 0.4 mm
box = "{} a"                 # periodic square
start = "lattice"            # lattice | random
duration = "5 s"
seed = 1

[granular.output]
frames = "0.05 s"
)";

constexpr const char* granular_rod = R"(
[[granular.rods]]
kind = "motile"              # tapered, walks thin end first
position = ["10 a", "{} a"]
heading = 0.0                # rad, of the thin end
)";

constexpr const char* bed_figures = R"(
[[figures]]
name = "bed"
kind = "snapshot"

[[figures]]
name = "tracks"
kind = "rod_tracks"
)";

/// As TOML has it, which knows no ".5".
std::string number(const Answers& answers, const std::string& option) {
    return fmt::format("{}", std::stod(answers.at(option)));
}

std::string rods_scene(const Answers& answers) {
    const int count = std::stoi(answers.at("--rods"));
    std::string text =
        fmt::format(theory, "Rods side by side in an elastic medium", number(answers, "--kappa"));
    for (int i = 0; i < count; ++i)
        text += fmt::format(rod, 2.5 * (count - 1) - 5.0 * i, 0);
    return text + rods_run;
}

std::string scan_scene(const Answers& answers) {
    const double largest = std::stod(answers.at("--kappa"));
    const bool crosses = answers.at("--start") == "perpendicular";
    std::string text = fmt::format(theory, "Which starts are captured", number(answers, "--kappa"));
    text += fmt::format(rod, 0.0, 0) + fmt::format(rod, -4.0, crosses ? 90 : 0);
    return text + (crosses ? fmt::format(scan, largest / 1000.0, largest, 0, -6.0, 6.0)
                           : fmt::format(scan, largest / 1000.0, largest, 1, -10.0, -0.5));
}

std::string bed_scene(const Answers& answers) {
    constexpr int lane = 15; // of a rod, bead radii
    const int count = std::stoi(answers.at("--rods"));
    const int box = std::max(2, count) * lane;
    std::string text = fmt::format(bed, number(answers, "--phi-b"), box);
    for (int i = 0; i < count; ++i)
        text += fmt::format(granular_rod, (i + 0.5) * box / count);
    return text + bed_figures;
}

/// Asks until the answer is legal. Throws InputError at the end of input.
std::string ask(const Question& question) {
    for (;;) {
        print_message(fmt::format("{} [{}] ", question.text, question.fallback));
        std::string answer;
        if (!std::getline(std::cin, answer))
            throw InputError("no answer; rodwake new --help names the options that answer");
        if (answer.empty())
            return question.fallback;
        const std::string wrong = question.legal(answer);
        if (wrong.empty())
            return answer;
        print_message(fmt::format("{}\n", wrong));
    }
}

/// The answers that the options give; the others are asked for on a terminal, and left at their defaults
/// elsewhere.
Answers answered(const Answers& given) {
    const bool asks = ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1;
    Answers answers;
    std::string kind;
    for (const Question& question : new_scene_questions()) {
        const std::string& answer = given.at(question.option);
        if (!question.is_for(kind)) {
            if (!answer.empty())
                throw InputError(
                    fmt::format("{}: a scene of kind {} has no use for it", question.option, kind));
            continue;
        }
        answers[question.option] = !answer.empty() ? answer : asks ? ask(question) : question.fallback;
        kind = answers.at("--kind");
    }
    return answers;
}

} // namespace

std::vector<Question> new_scene_questions() {
    const CLI::Validator kinds = one_of({"rods", "bed", "scan", "critical"});
    const CLI::Validator starts = one_of({"parallel", "perpendicular"});
    return {
        {"--kind", "",
         "What to model: rods (theory), bed (beads and rods), scan (phase diagram), critical (critical "
         "values)",
         "rods", kinds},
        {"--rods", "rods bed", "How many rods, 1 to 20", "2", whole_number_from(1, 20)},
        {"--start", "scan", "How the second rod starts: parallel or perpendicular", "perpendicular", starts},
        {"--kappa", "rods scan", "Coupling kappa to the strain (of a scan the largest)", "0.5",
         number_from(1e-6, 1e6)},
        {"--phi-b", "bed", "Area fraction phi_b of the beads", "0.78", number_from(0.05, 0.9)}};
}

int verb_new(const Options& options) {
    const auto answers = answered(options.answers);
    const std::string& kind = answers.at("--kind");
    const std::string text = kind == "bed"    ? bed_scene(answers)
                             : kind == "scan" ? scan_scene(answers)
                             : kind == "critical"
                                 ? (fmt::format(theory, "Critical coupling for capture", 1.0) +
                                    fmt::format(rod, 0.0, 0) + fmt::format(rod, -5.0, 90) + critical)
                                 : rods_scene(answers);
    scene::parse_scene(text, "the new scene"); // throws if it would not pass check
    if (options.target.empty()) {
        fmt::print("{}", text);
        return 0;
    }
    if (!options.force && std::filesystem::exists(options.target))
        throw InputError(options.target + ": already exists; choose another name, or --force to replace it");
    store::write_atomically(options.target, text);
    print_message(fmt::format("{}: written; rodwake check {} prints what it models, rodwake run {} runs it\n",
                              options.target, options.target, options.target));
    return 0;
}

} // namespace rodwake::cli
