#pragma once
// The field lists: each key of a scene stands here once, with unit, legal range and meaning.

#include "visitor.hpp"

namespace rodwake::scene {

inline constexpr std::size_t max_rods = 1000;

void fields(Visitor& v, Scales& scales);
void fields(Visitor& v, FieldTable& table);
void fields(Visitor& v, Medium& medium);
void fields(Visitor& v, Coupling& coupling);
void fields(Visitor& v, Noise& noise);
void fields(Visitor& v, Rod& rod);
void fields(Visitor& v, RodsRun& run);
void fields(Visitor& v, Cut& cut);
void fields(Visitor& v, Field& field);
void fields(Visitor& v, Figure& figure);
void fields(Visitor& v, Variant& variant);
void fields(Visitor& v, Scene& scene);

} // namespace rodwake::scene
