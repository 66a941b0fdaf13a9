// OpenGL objects that free themselves.
#include "viewer/gl/objects.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string_view>

#include <epoxy/gl.h>

#include "base/error.h"

namespace sparsha::viewer::gl {
namespace {

std::atomic<int> living{0};

struct FormatInfo {
  GLint internal;
  GLenum layout;
  GLenum type;
};

FormatInfo info_of(Format format) {
  switch (format) {
    case Format::rg32f:
      return {GL_RG32F, GL_RG, GL_FLOAT};
    case Format::rg16f:
      return {GL_RG16F, GL_RG, GL_FLOAT};
    case Format::r8:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case Format::rgba8:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::srgb8:
      return {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::depth32f:
      return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};
  }
  return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
}

Error failure(std::string wrong, std::string expected = {}) {
  return Error(ErrorKind::failure, {}, std::move(wrong), std::move(expected));
}

Name compile(GLenum kind, const std::string& source) {
  Name shader(glCreateShader(kind), [](unsigned name) { glDeleteShader(name); });
  const char* text = source.c_str();
  glShaderSource(shader.get(), 1, &text, nullptr);
  glCompileShader(shader.get());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
  if (compiled != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw failure("the graphics driver refused a shader: " + log, "a driver with OpenGL 3.3");
  }
  return shader;
}

void GLAPIENTRY collect(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum severity, GLsizei length,
                        const GLchar* message, const void* user) {
  const bool bad = type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR;
  if (!bad || severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
  auto* messages = static_cast<std::vector<std::string>*>(const_cast<void*>(user));
  messages->emplace_back(message, static_cast<std::size_t>(length));
}

}  // namespace

Name::Name(unsigned name, Delete destroy) : name_(name), destroy_(destroy) { ++living; }

void Name::reset() {
  if (name_ != 0 && destroy_ != nullptr) {
    destroy_(name_);
    --living;
  }
  name_ = 0;
}

int living_objects() { return living; }

Texture::Texture(int width, int height, Format format, Filter filter, const void* texels)
    : width_(width), height_(height), format_(format), filter_(filter) {
  unsigned name = 0;
  glGenTextures(1, &name);
  name_ = Name(name, [](unsigned n) { glDeleteTextures(1, &n); });
  const FormatInfo info = info_of(format);
  glBindTexture(GL_TEXTURE_2D, name);
  const GLint magnify = filter == Filter::nearest ? GL_NEAREST : GL_LINEAR;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, magnify);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter == Filter::mipmap ? GL_LINEAR_MIPMAP_LINEAR : magnify);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, info.internal, width, height, 0, info.layout, info.type, texels);
  if (filter == Filter::mipmap && texels != nullptr) glGenerateMipmap(GL_TEXTURE_2D);
}

void Texture::upload(const void* texels) {
  const FormatInfo info = info_of(format_);
  glBindTexture(GL_TEXTURE_2D, name_.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, info.layout, info.type, texels);
  if (filter_ == Filter::mipmap) glGenerateMipmap(GL_TEXTURE_2D);
}

void Texture::make_mipmaps() const {
  glBindTexture(GL_TEXTURE_2D, name_.get());
  glGenerateMipmap(GL_TEXTURE_2D);
}

void Texture::mix_levels(bool on) const {
  glBindTexture(GL_TEXTURE_2D, name_.get());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, on ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_NEAREST);
}

void Texture::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, name_.get());
  glActiveTexture(GL_TEXTURE0);
}

Target::Target(int width, int height, bool with_depth, Filter filter) : colour_(width, height, Format::rgba8, filter) {
  if (with_depth) depth_ = Texture(width, height, Format::depth32f, Filter::nearest);
  unsigned name = 0;
  glGenFramebuffers(1, &name);
  framebuffer_ = Name(name, [](unsigned n) { glDeleteFramebuffers(1, &n); });
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_.name(), 0);
  if (with_depth) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.name(), 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw failure("the graphics driver refused a picture of " + std::to_string(width) + " x " + std::to_string(height));
}

void Target::copy_to(unsigned framebuffer, int x, int y) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.get());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glBlitFramebuffer(0, 0, width(), height(), x, y, x + width(), y + height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

std::vector<unsigned char> read_pixels(unsigned framebuffer, int width, int height) {
  const auto row = static_cast<std::size_t>(width) * 4;
  std::vector<unsigned char> pixels(row * static_cast<std::size_t>(height));
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  for (int y = 0; y < height / 2; ++y) {
    const auto low = pixels.begin() + static_cast<std::ptrdiff_t>(row) * y;
    const auto high = pixels.begin() + static_cast<std::ptrdiff_t>(row) * (height - 1 - y);
    std::swap_ranges(low, low + static_cast<std::ptrdiff_t>(row), high);
  }
  return pixels;
}

std::vector<unsigned char> Target::read_pixels() const { return gl::read_pixels(framebuffer(), width(), height()); }

Program::Program(const std::string& vertex, const std::string& fragment) {
  const Name vertex_shader = compile(GL_VERTEX_SHADER, vertex);
  const Name fragment_shader = compile(GL_FRAGMENT_SHADER, fragment);
  name_ = Name(glCreateProgram(), [](unsigned name) { glDeleteProgram(name); });
  glAttachShader(name_.get(), vertex_shader.get());
  glAttachShader(name_.get(), fragment_shader.get());
  glLinkProgram(name_.get());
  GLint linked = GL_FALSE;
  glGetProgramiv(name_.get(), GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(name_.get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw failure("the graphics driver refused to link shaders: " + log, "a driver with OpenGL 3.3");
  }
  glDetachShader(name_.get(), vertex_shader.get());
  glDetachShader(name_.get(), fragment_shader.get());
}

void Program::use() const { glUseProgram(name_.get()); }

int Program::location(const char* uniform) const {
  const auto [found, added] = locations_.try_emplace(uniform, -1);
  if (added) found->second = glGetUniformLocation(name_.get(), uniform);
  return found->second;
}

void Program::set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
void Program::set_pair(const char* uniform, int x, int y) const { glUniform2i(location(uniform), x, y); }
void Program::set(const char* uniform, float value) const { glUniform1f(location(uniform), value); }
void Program::set(const char* uniform, const Eigen::Vector2f& value) const {
  glUniform2fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Eigen::Vector3f& value) const {
  glUniform3fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Eigen::Vector4f& value) const {
  glUniform4fv(location(uniform), 1, value.data());
}
void Program::set(const char* uniform, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}

Name make_vertex_array() {
  unsigned name = 0;
  glGenVertexArrays(1, &name);
  return {name, [](unsigned n) { glDeleteVertexArrays(1, &n); }};
}

Name make_buffer() {
  unsigned name = 0;
  glGenBuffers(1, &name);
  return {name, [](unsigned n) { glDeleteBuffers(1, &n); }};
}

int max_texture_size() {
  GLint size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &size);
  return size;
}

bool is_software() {
  const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  if (text == nullptr) return true;
  const std::string_view renderer(text);
  return std::ranges::any_of(std::vector<std::string_view>{"llvmpipe", "softpipe", "swrast", "SwiftShader"},
                             [&](std::string_view name) { return renderer.find(name) != std::string_view::npos; });
}

bool watch_errors(std::vector<std::string>& messages) {
  if (!epoxy_has_gl_extension("GL_KHR_debug")) return false;
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(collect, &messages);
  return true;
}

}  // namespace sparsha::viewer::gl
