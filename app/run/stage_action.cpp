#include "stage_action.hpp"

namespace rodwake::app {

StageAction stage_action(const StageFacts& stage) {
    using enum StageAction;
    if (stage.record == StageRecord::absent)
        return stage.asked ? start : leave;
    if (stage.asked && stage.force)
        return start;
    if (stage.asked && stage.light && stage.record == StageRecord::unfinished)
        return resume;
    if (!stage.same_scene)
        return stage.force ? drop : refuse;
    if (!stage.asked)
        return keep;
    if (stage.record == StageRecord::unfinished)
        return resume;
    if (stage.wants_more)
        return extend;
    return stage.record == StageRecord::lost ? restore : keep;
}

} // namespace rodwake::app
