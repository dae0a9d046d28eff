// The table has all cases of a stage in a run folder.

#include "run/stage_action.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <optional>

using namespace rodwake::app;

namespace {

/// A row of the table; what is not given may be either.
struct Case {
    StageRecord record;
    std::optional<bool> asked, same_scene, wants_more, light, force;
    StageAction action;
};

using enum StageAction;
using Record = StageRecord;
constexpr auto any = std::nullopt;
constexpr Case table[] = {
    //    record        asked  same   more   light  force
    {Record::absent, true, any, any, any, any, start},
    {Record::absent, false, any, any, any, any, leave},

    {Record::unfinished, true, any, any, any, true, start},
    {Record::unfinished, true, any, any, true, false, resume},
    {Record::unfinished, true, true, any, false, false, resume},
    {Record::unfinished, true, false, any, false, false, refuse},
    {Record::unfinished, false, true, any, any, any, keep},
    {Record::unfinished, false, false, any, any, false, refuse},
    {Record::unfinished, false, false, any, any, true, drop},

    {Record::finished, true, any, any, any, true, start},
    {Record::finished, true, true, false, any, false, keep},
    {Record::finished, true, true, true, any, false, extend},
    {Record::finished, true, false, any, any, false, refuse},
    {Record::finished, false, true, any, any, any, keep},
    {Record::finished, false, false, any, any, false, refuse},
    {Record::finished, false, false, any, any, true, drop},

    {Record::lost, true, any, any, any, true, start},
    {Record::lost, true, true, false, any, false, restore},
    {Record::lost, true, true, true, any, false, extend},
    {Record::lost, true, false, any, any, false, refuse},
    {Record::lost, false, true, any, any, any, keep},
    {Record::lost, false, false, any, any, false, refuse},
    {Record::lost, false, false, any, any, true, drop},
};

bool is_case(const Case& row, const StageFacts& facts) {
    const auto is = [](std::optional<bool> wanted, bool fact) { return wanted.value_or(fact) == fact; };
    return row.record == facts.record && is(row.asked, facts.asked) && is(row.same_scene, facts.same_scene) &&
           is(row.wants_more, facts.wants_more) && is(row.light, facts.light) && is(row.force, facts.force);
}

} // namespace

TEST_CASE("Every case of a stage has one action") {
    for (const Record record : {Record::absent, Record::unfinished, Record::finished, Record::lost})
        for (int bits = 0; bits < 32; ++bits) {
            const StageFacts facts{record,          (bits & 1) != 0, (bits & 2) != 0,
                                   (bits & 4) != 0, (bits & 8) != 0, (bits & 16) != 0};
            CAPTURE(static_cast<int>(record), facts.asked, facts.same_scene, facts.wants_more, facts.light,
                    facts.force);
            REQUIRE(std::ranges::count_if(table, [&](const Case& row) { return is_case(row, facts); }) == 1);
            const Case* row =
                std::ranges::find_if(table, [&](const Case& each) { return is_case(each, facts); });
            CHECK(stage_action(facts) == row->action);
        }
}
