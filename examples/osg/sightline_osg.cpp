#include "examples/osg/sightline_osg.hpp"

#include <utility>

#include "examples/osg/culling.hpp"

namespace sightline::osg_culling {

Culler::Culler(osg::Node* scene_root, Options options)
    : culling_(new Culling(scene_root, std::move(options))) {}

Culler::Culler(osg::Node* scene_root, const std::string& endpoint)
    : Culler(scene_root, Options{.endpoint = endpoint}) {}

Culler::~Culler() {
  culling_->take_down(true);
}

void Culler::cull(osg::Camera* camera, ViewKind kind) {
  culling_->add_camera(camera, kind);
}

void Culler::refresh() {
  culling_->take_down(false);
}

void Culler::set_enabled(bool enabled) {
  culling_->set_enabled(enabled);
}

bool Culler::wait_until_open(double timeout_s) {
  return culling_->wait_until_open(timeout_s);
}

Statistics Culler::statistics() const {
  return culling_->statistics();
}

}  // namespace sightline::osg_culling
