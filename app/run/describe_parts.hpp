#pragma once
// The pieces of describe(), one for each group of tables.

#include "rodwake/app/describe.hpp"

#include <string>

namespace rodwake::app {

using Lines = std::vector<PlanLine>;

void describe_granular(const Plan& plan, Lines& lines);
void describe_tracks(const Plan& plan, Lines& lines);
void describe_measures(const BedPlan& bed, Lines& lines);
void describe_fit(const Plan& plan, Lines& lines);

/// "31.5 MB"
std::string size_text(double bytes);

} // namespace rodwake::app
