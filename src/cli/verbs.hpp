#pragma once
// One function a verb; each returns the exit code and throws InputError or RunError.

#include "options.hpp"

namespace rodwake::cli {

int verb_check(const Options& options);
int verb_field_points(const Options& options);
int verb_impact(const Options& options);
int verb_measure(const Options& options);
int verb_fit(const Options& options);
int verb_stages(const Options& options); ///< field, rods and run: the stages the verb stands for
int verb_plot(const Options& options);
int verb_info(const Options& options);

} // namespace rodwake::cli
