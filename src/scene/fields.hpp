#pragma once
// The field lists: each key of a scene stands here once, with unit, legal range and meaning.

#include "visitor.hpp"

namespace rodwake::scene {

inline constexpr std::size_t max_rods = 1000;

/// Whether a figure is of the granular bed, or of what was measured in it; such figures need [granular] and
/// have their window in metres.
bool shows_the_bed(const Figure& figure);
/// Whether it is of what [measure] found.
bool shows_measures(const Figure& figure);

void fields(Visitor& v, Scales& scales);
void fields(Visitor& v, FieldTable& table);
void fields(Visitor& v, Medium& medium);
void fields(Visitor& v, Coupling& coupling);
void fields(Visitor& v, Noise& noise);
void fields(Visitor& v, Rod& rod);
void fields(Visitor& v, RodsRun& run);
void fields(Visitor& v, Cut& cut);
void fields(Visitor& v, Field& field);
void fields(Visitor& v, Plates& plates);
void fields(Visitor& v, Surface& surface);
void fields(Visitor& v, SurfaceChange& change);
void fields(Visitor& v, Contacts& contacts);
void fields(Visitor& v, GranularOutput& output);
void fields(Visitor& v, GranularRod& rod);
void fields(Visitor& v, Granular& granular);
void fields(Visitor& v, Measure& measure);
/// The window is in the units of the scene, or of the bed if that is what is drawn.
void fields(Visitor& v, Figure& figure, const Units& of_scene, const Units& of_bed);
void fields(Visitor& v, Variant& variant);
void fields(Visitor& v, Scene& scene);

} // namespace rodwake::scene
