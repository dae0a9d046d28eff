#pragma once
// stage_action decides what a command does with one stage of a run folder. It answers "what of this is done
// already?" from six facts; tests/app/test_stage_action.cpp has all cases as a table.
//
//   of the folder   asked for                                       not asked for
//   absent          start                                           leave
//   unfinished      of the same scene: resume; else refuse          of the same scene: keep; else refuse
//   finished        of the same scene: keep, or extend if it wants  the same
//                   more; else refuse
//   files lost      of the same scene: restore, or extend; else     the same scene: keep; else refuse
//                   refuse
//
// --force begins what is asked for, and drops what would be refused.

namespace rodwake::app {

enum class StageRecord { absent, unfinished, finished, lost }; ///< lost: it was finished, and files are gone

struct StageFacts {
    StageRecord record = StageRecord::absent;
    bool asked = false;      ///< the command asks for it
    bool same_scene = false; ///< its key is that of the scene (stage_key), and the scene does not conflict
    bool wants_more = false; ///< the scene asks for more than it has: runs, a later end, points
    bool light = false;      ///< unfinished, it resumes for another scene too: its files know their own
    bool force = false;
};

enum class StageAction {
    leave,   ///< the folder has none and gets none
    start,   ///< from nothing; what is there is removed
    resume,  ///< from what an interrupted command left
    extend,  ///< a finished one goes on
    restore, ///< files that are gone are made again, with the same content
    keep,    ///< results stay as they are
    refuse,  ///< the command ends before anything is touched
    drop     ///< removed, since it is of another scene
};

StageAction stage_action(const StageFacts& stage);

} // namespace rodwake::app
