#version 450 core
// A piece of chrome seen in another: where it is seen there (chrome.vert), and its own surface.
layout(location = 0) in vec3 fromEye;  // in the other piece's frame
layout(location = 1) in vec3 position;
layout(location = 2) in vec3 normal;
layout(location = 3) in vec3 from;  // where on the other piece it is seen
layout(location = 4) in vec3 at;    // its place whose look in the picture it takes
uniform mat4 clipFromVirtual;
uniform vec3 pictureEye;
layout(location = 0) out vec3 positionOut;
layout(location = 1) out vec3 normalOut;
layout(location = 2) out vec3 fromOut;
layout(location = 3) out vec3 atOut;  // relative to the picture's eye

void main() {
    gl_Position = clipFromVirtual * vec4(fromEye, 1.0);
    positionOut = position;
    normalOut = normal;
    fromOut = from;
    atOut = at - pictureEye;
}
