// The source's side of XDND: it owns the selection, tells where it is, drops, and hands over the list when asked.
#ifdef SPARSHA_HAS_X11
#include "tests/viewer/window/drop.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <chrono>
#include <thread>

namespace sparsha::viewer::test {
namespace {

class Source {
 public:
  explicit Source(::Window target) : display_(XOpenDisplay(nullptr)), target_(target) {
    if (display_ == nullptr) return;
    own_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display_, atom("XdndSelection"), own_, CurrentTime);
  }
  ~Source() {
    if (display_ != nullptr) XCloseDisplay(display_);
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  bool drop(const std::string& uri_list) {
    if (display_ == nullptr) return false;
    XWindowAttributes place;
    ::Window child = 0;
    int x = 0, y = 0;
    if (XGetWindowAttributes(display_, target_, &place) == 0) return false;
    XTranslateCoordinates(display_, target_, place.root, place.width / 2, place.height / 2, &x, &y, &child);
    constexpr long kVersion = 5;
    send("XdndEnter", kVersion << 24, static_cast<long>(atom("text/uri-list")), 0, 0);
    send("XdndPosition", 0, (static_cast<long>(x) << 16) | y, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
    if (!wait_for("XdndStatus", uri_list)) return false;
    send("XdndDrop", 0, CurrentTime, 0, 0);
    return wait_for("XdndFinished", uri_list);
  }

 private:
  [[nodiscard]] Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

  void send(const char* what, long second, long third, long fourth, long fifth) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target_;
    event.xclient.message_type = atom(what);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(own_);
    event.xclient.data.l[1] = second;
    event.xclient.data.l[2] = third;
    event.xclient.data.l[3] = fourth;
    event.xclient.data.l[4] = fifth;
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }

  void answer(const XSelectionRequestEvent& request, const std::string& uri_list) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(uri_list.data()), static_cast<int>(uri_list.size()));
    XEvent reply{};
    reply.xselection.type = SelectionNotify;
    reply.xselection.requestor = request.requestor;
    reply.xselection.selection = request.selection;
    reply.xselection.target = request.target;
    reply.xselection.property = request.property;
    reply.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &reply);
    XFlush(display_);
  }

  bool wait_for(const char* what, const std::string& uri_list) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < end) {
      while (XPending(display_) > 0) {
        XEvent event;
        XNextEvent(display_, &event);
        if (event.type == SelectionRequest) answer(event.xselectionrequest, uri_list);
        if (event.type == ClientMessage && event.xclient.message_type == atom(what)) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  Display* display_;
  ::Window target_;
  ::Window own_ = 0;
};

}  // namespace

bool ask_to_close(unsigned long window) {
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return false;
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = window;
  event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
  const bool sent = XSendEvent(display, window, False, NoEventMask, &event) != 0;
  XCloseDisplay(display);
  return sent;
}

bool drop_files(unsigned long window, const std::string& uri_list) { return Source(window).drop(uri_list); }

}  // namespace sparsha::viewer::test
#endif
