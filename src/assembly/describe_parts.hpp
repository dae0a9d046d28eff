#pragma once
// The pieces of describe(), one for each group of tables.

#include "rodwake/assembly/describe.hpp"

namespace rodwake::assembly {

using Lines = std::vector<PlanLine>;

void describe_granular(const Plan& plan, Lines& lines);
void describe_measures(const BedPlan& bed, Lines& lines);
void describe_fit(const Plan& plan, Lines& lines);

} // namespace rodwake::assembly
