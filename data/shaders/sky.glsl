// Twin of app::skyRadiance in app/frame/Sky.cpp.
vec3 skyRadiance(vec3 direction) {
    vec3 mean = frame.skyIrradiance.rgb * inversePi;
    float up = max(direction.z, 0.0);
    float low = 1.0 - up;
    float low2 = low * low;
    vec3 zenith = mean * vec3(0.6, 0.86, 1.2);
    float grey = 0.33 * (mean.r + mean.g + mean.b);
    vec3 horizon = mix(mean, vec3(grey), 0.55) * 1.9;
    vec3 radiance = mix(zenith, horizon, low2 * low2);

    float cosine = dot(direction, frame.sunDirection.xyz);
    float facing = max(cosine, 0.0);
    float f2 = facing * facing;
    float f4 = f2 * f2;
    float f8 = f4 * f4;
    float f16 = f8 * f8;
    float f32 = f16 * f16;
    float f64 = f32 * f32;
    float f128 = f64 * f64;
    float f256 = f128 * f128;
    radiance += frame.sunIrradiance.rgb * (0.02 * frame.sunDirection.w) * (0.12 * f4 + 0.55 * f64 + 2.2 * f256 * f64);

    float below = min(max(-direction.z, 0.0) * 6.0, 1.0);
    radiance = mix(radiance, frame.groundIrradiance.rgb * inversePi, below);
    bool disc = cosine > 0.99996192 && direction.z > -0.01;
    return disc ? min(frame.sunIrradiance.rgb * 100.0, vec3(200.0)) : radiance;
}
