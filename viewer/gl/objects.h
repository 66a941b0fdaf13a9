// OpenGL objects that free themselves. All of it belongs to the thread whose context is current.
#pragma once

#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace sparsha::viewer::gl {

/// One name of an OpenGL object of a kind; moves, never copies.
class Name {
 public:
  using Delete = void (*)(unsigned name);
  Name() = default;
  Name(unsigned name, Delete destroy);
  ~Name() { reset(); }
  Name(Name&& other) noexcept
      : name_(std::exchange(other.name_, 0U)), destroy_(std::exchange(other.destroy_, nullptr)) {}
  Name& operator=(Name&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = std::exchange(other.name_, 0U);
      destroy_ = std::exchange(other.destroy_, nullptr);
    }
    return *this;
  }
  Name(const Name&) = delete;
  Name& operator=(const Name&) = delete;

  [[nodiscard]] unsigned get() const { return name_; }
  [[nodiscard]] explicit operator bool() const { return name_ != 0; }
  void reset();

 private:
  unsigned name_ = 0;
  Delete destroy_ = nullptr;
};

/// What a texel holds.
enum class Format {
  rg32f,  ///< heights and the ground behind; read by texelFetch only
  rg16f,  ///< slopes
  r8,     ///< light visibility
  rgba8,  ///< tones and pictures
  srgb8,  ///< paint: colours that are decoded to linear light when sampled
  depth32f
};
enum class Filter { nearest, linear, mipmap };

/// A two-dimensional texture.
class Texture {
 public:
  Texture() = default;
  /// `texels` has width * height of the format's texels (rg32f, rg16f: floats; others: bytes), first row at the bottom;
  /// null leaves them undefined.
  Texture(int width, int height, Format format, Filter filter, const void* texels = nullptr);

  /// Replaces all texels; the same size.
  void upload(const void* texels);
  /// After drawing into a mipmap texture.
  void make_mipmaps() const;
  /// Of a mipmap texture: colours between two levels are mixed of both, or taken from the nearer one.
  void mix_levels(bool on) const;
  void bind(int unit) const;
  [[nodiscard]] unsigned name() const { return name_.get(); }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(name_); }

 private:
  Name name_;
  int width_ = 0;
  int height_ = 0;
  Format format_ = Format::rgba8;
  Filter filter_ = Filter::nearest;
};

/// A picture to draw into: colour and, when asked for, depth.
class Target {
 public:
  Target() = default;
  /// Throws Error{failure} when the driver refuses the size.
  Target(int width, int height, bool with_depth, Filter filter = Filter::linear);

  [[nodiscard]] const Texture& colour() const { return colour_; }
  [[nodiscard]] const Texture& depth() const { return depth_; }
  [[nodiscard]] unsigned framebuffer() const { return framebuffer_.get(); }
  [[nodiscard]] int width() const { return colour_.width(); }
  [[nodiscard]] int height() const { return colour_.height(); }
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(framebuffer_); }
  /// Copies the colours so that their lower left corner comes to (x, y) of another framebuffer.
  void copy_to(unsigned framebuffer, int x, int y) const;
  /// Replaces the colours: RGBA bytes, first row at the bottom.
  void upload(const void* texels) { colour_.upload(texels); }
  /// RGBA bytes, first row at the TOP.
  [[nodiscard]] std::vector<unsigned char> read_pixels() const;

 private:
  Texture colour_;
  Texture depth_;
  Name framebuffer_;
};

/// A linked pair of shaders. Unknown uniform names are ignored, as the linker may have dropped them.
class Program {
 public:
  Program() = default;
  /// Throws Error{failure} with the compiler's words.
  Program(const std::string& vertex, const std::string& fragment);

  void use() const;
  void set(const char* uniform, int value) const;  ///< int, bool, sampler
  void set_pair(const char* uniform, int x, int y) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const Eigen::Vector2f& value) const;
  void set(const char* uniform, const Eigen::Vector3f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;

 private:
  [[nodiscard]] int location(const char* uniform) const;
  Name name_;
  mutable std::unordered_map<std::string, int> locations_;
};

[[nodiscard]] Name make_vertex_array();
[[nodiscard]] Name make_buffer();

/// Names not yet deleted, in all contexts; for tests of leaks.
[[nodiscard]] int living_objects();

/// RGBA bytes of a framebuffer, first row at the TOP.
[[nodiscard]] std::vector<unsigned char> read_pixels(unsigned framebuffer, int width, int height);

/// Largest texture side that the driver takes.
[[nodiscard]] int max_texture_size();
/// True for renderers that run on the processor (llvmpipe, softpipe).
[[nodiscard]] bool is_software();
/// Collects errors and warnings of undefined behaviour from now on (KHR_debug); false when the driver has none.
bool watch_errors(std::vector<std::string>& messages);

}  // namespace sparsha::viewer::gl
