#include <omnitag/AddMarker.h>
#include <omnitag/LocalizationStatus.h>
#include <omnitag/MarkerDetectionArray.h>

#include <cstdio>

int main() {
  omnitag::MarkerDetectionArray message;
  message.detections.emplace_back();
  message.detections.back().family = "tag36h11";
  omnitag::AddMarker::Request request;
  request.id = 7;
  std::printf("%s %d %d\n", message.detections.back().family.c_str(), static_cast<int>(request.id),
              static_cast<int>(omnitag::LocalizationStatus::FOUND));
}
