#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "app/report/Picture.h"

namespace app {

/// An MP4 video written by an ffmpeg process through a pipe: H.264 where that ffmpeg can, MPEG-4 part 2
/// otherwise. The process has a group of its own, so that an interrupt from the terminal does not reach it:
/// when this program ends early, even by being killed, ffmpeg sees the end of its input and finishes the file
/// that it has written aside.
class VideoWriter {
  public:
    /// Throws std::runtime_error when ffmpeg is missing or does not start. Width and height: 2 to 16384; odd
    /// ones are padded by a pixel, as the pixel format wants it.
    VideoWriter(std::filesystem::path file, int width, int height, int framesPerSecond);
    /// Finishes the video as far as it goes; without a frame, no file is left.
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// Throws std::runtime_error when ffmpeg has gone or the picture has another size.
    void add(const Picture& picture);
    /// Waits for ffmpeg and gives the file its name. Throws std::runtime_error with ffmpeg's exit code when
    /// it failed.
    void finish();

    std::size_t frames() const;
    const std::string& encoder() const;  ///< "libx264" or "mpeg4"

    /// Whether there is an ffmpeg to write videos with.
    static bool available();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace app
