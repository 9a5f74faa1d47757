#include "app/report/VideoWriter.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "app/report/AsideFile.h"

namespace app {

namespace {

/// The encoders that ffmpeg lists, as one text; empty when there is no ffmpeg.
std::string ffmpegEncoders() {
    std::string text;
    FILE* pipe = popen("ffmpeg -hide_banner -loglevel quiet -encoders 2>/dev/null </dev/null", "r");
    if (pipe == nullptr) return text;
    std::array<char, 4096> buffer;
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
        text.append(buffer.data(), n);
    return pclose(pipe) == 0 ? text : std::string();
}

}  // namespace

struct VideoWriter::Impl {
    AsideFile file;
    int width;
    int height;
    std::string encoder;
    pid_t process = -1;
    int pipe = -1;
    std::size_t frames = 0;

    void start(int framesPerSecond);
    int closeAndWait();
};

void VideoWriter::Impl::start(int framesPerSecond) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    const std::string rate = std::to_string(framesPerSecond);
    std::vector<std::string> words{"ffmpeg",    "-hide_banner",
                                   "-loglevel", "error",
                                   "-y",        "-f",
                                   "rawvideo",  "-pixel_format",
                                   "rgba",      "-video_size",
                                   size,        "-framerate",
                                   rate,        "-i",
                                   "pipe:0",    "-an",
                                   "-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                   "-pix_fmt",  "yuv420p",
                                   "-c:v",      encoder};
    const std::vector<std::string> quality =
        encoder == "libx264" ? std::vector<std::string>{"-preset", "veryfast", "-crf", "19"}
                             : std::vector<std::string>{"-qscale:v", "3"};
    words.insert(words.end(), quality.begin(), quality.end());
    // The prefix keeps ffmpeg from taking a name for an option or for a protocol.
    words.insert(words.end(), {"-movflags", "+faststart", "-f", "mp4", "file:" + file.aside().string()});
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);

    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
        throw std::runtime_error(std::string("cannot make a pipe to ffmpeg (") + std::strerror(errno) +
                                 "); close other programs.");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    // A group of its own: Ctrl-C in the terminal is for this program, which then closes the pipe.
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int error = posix_spawnp(&process, "ffmpeg", &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    if (error != 0) {
        close(ends[1]);
        process = -1;
        throw std::runtime_error(std::string("cannot start ffmpeg (") + std::strerror(error) +
                                 "); install the package ffmpeg.");
    }
    pipe = ends[1];
}

int VideoWriter::Impl::closeAndWait() {
    if (pipe >= 0) close(std::exchange(pipe, -1));
    if (process < 0) return -1;
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    process = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

VideoWriter::VideoWriter(std::filesystem::path file, int width, int height, int framesPerSecond) {
    if (width < 2 || height < 2 || width > 16384 || height > 16384 || framesPerSecond < 1)
        throw std::runtime_error("a video of " + std::to_string(width) + "x" + std::to_string(height) +
                                 " pixels cannot be written to '" + file.string() +
                                 "'; choose 2x2 to 16384x16384.");
    const std::string encoders = ffmpegEncoders();
    if (encoders.empty())
        throw std::runtime_error("there is no working ffmpeg to write '" + file.string() +
                                 "'; install the package ffmpeg.");
    impl_.reset(new Impl{.file = AsideFile(std::move(file)),
                         .width = width,
                         .height = height,
                         .encoder = encoders.find(" libx264 ") != std::string::npos ? "libx264" : "mpeg4"});
    impl_->start(framesPerSecond);
}

VideoWriter::~VideoWriter() {
    try {
        if (impl_->process >= 0) finish();
    } catch (const std::exception&) {
        // Whoever wants to know why calls finish() or add(), which have said it.
    }
}

void VideoWriter::add(const Picture& picture) {
    if (picture.width != impl_->width || picture.height != impl_->height ||
        picture.rgba.size() !=
            static_cast<std::size_t>(impl_->width) * static_cast<std::size_t>(impl_->height) * 4)
        throw std::runtime_error("a picture of another size cannot join the video '" +
                                 impl_->file.file().string() + "'.");
    const std::uint8_t* data = picture.rgba.data();
    std::size_t left = picture.rgba.size();
    while (left > 0) {
        const ssize_t n = write(impl_->pipe, data, left);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            const int code = impl_->closeAndWait();
            throw std::runtime_error("ffmpeg stopped while writing '" + impl_->file.file().string() +
                                     "' (exit code " + std::to_string(code) +
                                     "); look at its message above, and make room if the disk is full.");
        }
        data += n;
        left -= static_cast<std::size_t>(n);
    }
    ++impl_->frames;
}

void VideoWriter::finish() {
    if (impl_->process < 0) return;
    const int code = impl_->closeAndWait();
    if (impl_->frames == 0) return;
    if (code != 0)
        throw std::runtime_error("ffmpeg could not finish '" + impl_->file.file().string() + "' (exit code " +
                                 std::to_string(code) +
                                 "); look at its message above, and make room if the disk is full.");
    impl_->file.commit();
}

std::size_t VideoWriter::frames() const {
    return impl_->frames;
}
const std::string& VideoWriter::encoder() const {
    return impl_->encoder;
}
bool VideoWriter::available() {
    return !ffmpegEncoders().empty();
}

}  // namespace app
