#include "examples/osg/headless_window.hpp"

#include <array>
#include <osg/Image>
#include <stdexcept>

#include <EGL/egl.h>
#include <EGL/eglext.h>

namespace sightline::osg_example {

HeadlessWindow::HeadlessWindow(int width, int height) : GraphicsWindowEmbedded(0, 0, width, height) {
  const auto require = [](bool done, const char* call) {
    if (!done) throw std::runtime_error(std::string("no OpenGL without a display: ") + call + " failed");
  };
  display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  require(display_ != EGL_NO_DISPLAY, "eglGetPlatformDisplay(surfaceless)");
  require(eglInitialize(display_, nullptr, nullptr) == EGL_TRUE, "eglInitialize");
  require(eglBindAPI(EGL_OPENGL_API) == EGL_TRUE, "eglBindAPI(OpenGL)");
  // The compatibility profile: OpenSceneGraph as Debian builds it draws with OpenGL 2's functions, too.
  constexpr std::array<EGLint, 3> attributes = {EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT, EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
  require(context_ != EGL_NO_CONTEXT, "eglCreateContext(compatibility profile)");
  require(eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE, "eglMakeCurrent");
}

HeadlessWindow::~HeadlessWindow() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
}

void draw_without_display(osgViewer::Viewer& viewer, int width, int height, osg::Image& image,
                          osg::Image& depth) {
  image.allocateImage(width, height, 1, GL_RGBA, GL_UNSIGNED_BYTE);
  depth.allocateImage(width, height, 1, GL_DEPTH_COMPONENT, GL_FLOAT);
  depth.setInternalTextureFormat(GL_DEPTH_COMPONENT32F);
  osg::Camera& camera = *viewer.getCamera();
  camera.setGraphicsContext(new HeadlessWindow(width, height));
  camera.setViewport(0, 0, width, height);
  camera.setRenderTargetImplementation(osg::Camera::FRAME_BUFFER_OBJECT);
  camera.attach(osg::Camera::COLOR_BUFFER, &image);
  camera.attach(osg::Camera::DEPTH_BUFFER, &depth);
  viewer.setThreadingModel(osgViewer::Viewer::SingleThreaded);
  viewer.setKeyEventSetsDone(0);
}

}  // namespace sightline::osg_example
