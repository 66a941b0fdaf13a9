// The shaders' text (GLSL 3.30). One pair a purpose.
#pragma once

namespace sparsha::viewer::gl {

extern const char* const kReliefVertex;      ///< lattice and slab sides from a height texture, no vertex buffers; WALL
extern const char* const kStoneLight;        ///< functions: colour under key light, sky and bounce; as clay
extern const char* const kStoneFragment;     ///< a relief's, node by node; after kVersion and kStoneLight
extern const char* const kReliefFragment;    ///< that colour; WALL, WITH_UNKNOWN, WITH_OUTLINE, WITH_FILLED, ...
extern const char* const kObjectVertex;      ///< a whole object's vertices
extern const char* const kObjectFragment;    ///< their light; WITH_CLAY, WITH_CONTOUR, WITH_SECTION; after kStoneLight
extern const char* const kVersion;           ///< goes before the texts of relief and object and their #defines
extern const char* const kWholeVertex;       ///< one triangle over everything
extern const char* const kBackdropFragment;  ///< what is behind the stone
extern const char* const kResolveFragment;   ///< 2x2 pixels to one, in linear light; EYE_DOME; without version
extern const char* const kSectionVertex;     ///< the cut face of a section plane
extern const char* const kSectionFragment;
extern const char* const kAnaglyphFragment;  ///< two eyes to red and cyan (Dubois 2001)
extern const char* const kRectVertex;        ///< a rectangle in pixels
extern const char* const kDecalFragment;     ///< the hand's shadow and the glow of contact, laid on the surface
extern const char* const kBallFragment;      ///< a sphere, ray by ray, hidden by the surface
extern const char* const kInkVertex;         ///< flat triangles in pixels with a colour at each corner
extern const char* const kInkFragment;

}  // namespace sparsha::viewer::gl
