#pragma once
// The field lists: each key of a scene stands here once, with unit, legal range and meaning.

#include "visitor.hpp"

namespace rodwake::scene {

inline constexpr std::size_t max_rods = 1000;                 // one by one; at random a hundred times as many
inline constexpr double largest_seed = 9223372036854775807.0; // 2^63 - 1, the largest TOML integer

void fields(Visitor& v, Scales& scales);
void fields(Visitor& v, FieldTable& table);
void fields(Visitor& v, MeasuredMedium& measured);
void fields(Visitor& v, medium::DynamicMedium& dynamic);
void fields(Visitor& v, Medium& medium);
void fields(Visitor& v, Coupling& coupling);
void fields(Visitor& v, Noise& noise);
void fields(Visitor& v, rods::BodyShape& shape);
void fields(Visitor& v, Body& body);
void fields(Visitor& v, Rod& rod);
void fields(Visitor& v, RandomRods& random, const std::optional<Body>& body);
void fields(Visitor& v, RodsRun& run);
void fields(Visitor& v, RodsOrder& order);
void fields(Visitor& v, Cut& cut);
void fields(Visitor& v, Field& field);
void fields(Visitor& v, granular::Surface& surface);
void fields(Visitor& v, granular::BodyForce& force);
void fields(Visitor& v, SurfaceChange& change);
void fields(Visitor& v, BedContainer& container);
void fields(Visitor& v, Contacts& contacts);
void fields(Visitor& v, GranularOutput& output);
void fields(Visitor& v, GranularRod& rod);
void fields(Visitor& v, granular::BeadKind& kind);
void fields(Visitor& v, RandomBedRods& random);
void fields(Visitor& v, Granular& granular);
void fields(Visitor& v, TracksColumns& columns);
void fields(Visitor& v, TracksKind& kind);
void fields(Visitor& v, Tracks& tracks);
void fields(Visitor& v, Measure& measure);
void fields(Visitor& v, FitMask& mask);
void map_fields(Visitor& v, Fit& fit);
void fields(Visitor& v, FitCompare& compare);
void fields(Visitor& v, FitPosterior& posterior);
/// What lengths mean in [fit], and what reduced units are in a file of tracks unless it says otherwise.
struct FitUnits {
    Units profiles, tracks;
    Scales scales;
};
void fields(Visitor& v, FitProfile& profile, const FitUnits& units);
void fields(Visitor& v, FitMap& map, const FitUnits& units);
/// Units of a file's columns: of places, and of what else it holds.
void column_fields(Visitor& v, ColumnUnits& columns, const FitUnits& units);
void fields(Visitor& v, FitTrajectory& trajectory, const FitUnits& units);
void fields(Visitor& v, Fit& fit, FitUnits units);
/// Units of a figure's window, by what is drawn.
struct FigureUnits {
    Units scene, bed, fit;
};
void fields(Visitor& v, Figure& figure, const FigureUnits& units);
void fields(Visitor& v, Variant& variant);
void fields(Visitor& v, FitModel& model);
void fields(Visitor& v, ScanAxis& axis);
void fields(Visitor& v, ScanRefine& refine);
void fields(Visitor& v, Scan& scan);
void fields(Visitor& v, Scene& scene);

} // namespace rodwake::scene
