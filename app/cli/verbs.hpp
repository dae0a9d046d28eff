#pragma once
// One function a verb; each returns the exit code and throws InputError or RunError.

#include "options.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rodwake::cli {

int verb_scenes(const Options& options);
int verb_new(const Options& options);
int verb_check(const Options& options);
int verb_field_points(const Options& options);
int verb_impact(const Options& options);
int verb_stages(
    const Options& options); ///< field, rods, dem, measure, fit, run: the stages the verb stands for
/// tradeoff, design, camera: carried out by Python (commands/rodwake_commands).
int verb_python(const Options& options, const std::string& name);
int verb_convert(const Options& options);
int verb_replay(const Options& options);
int verb_explore(const Options& options);
int verb_plot(const Options& options);
int verb_info(const Options& options);
int verb_help(const Options& options);

/// What is installed beside the program (plots, scenes, problems of fits with their data): share/rodwake of
/// the installation the program is part of, else the source tree it was built from.
std::filesystem::path shipped_folder();

/// The scene of the command line with its -s settings. Throws InputError, which says where a shipped scene is
/// found.
scene::Scene scene_of(const Options& options);

/// Figures and report.html by the plotting program. Throws RunError if it cannot be run or fails; a stop
/// signal ends it early, and it returns.
void make_figures(const std::filesystem::path& run_directory, bool pdf, bool quiet,
                  const std::vector<std::string>& looks = {});

} // namespace rodwake::cli
