#pragma once

#include <osgViewer/GraphicsWindow>
#include <osgViewer/Viewer>

namespace sightline::osg_example {

/// An OpenGL context without a display, through EGL, that a viewer draws in; its images go to a frame buffer
/// object, since there is nothing else to draw to. The context is current in the thread that made the window.
class HeadlessWindow : public osgViewer::GraphicsWindowEmbedded {
 public:
  /// Throws std::runtime_error naming the call that failed.
  HeadlessWindow(int width, int height);

 protected:
  ~HeadlessWindow() override;

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

/// Lets `viewer` draw its own camera into `image` (RGBA, 8 bits each, `width` x `height`, bottom row first)
/// and `depth` (32-bit float, 0 near to 1 far), without a display and in the calling thread.
/// Throws std::runtime_error naming the call that failed.
void draw_without_display(osgViewer::Viewer& viewer, int width, int height, osg::Image& image,
                          osg::Image& depth);

}  // namespace sightline::osg_example
