// Evaluates the lookups of shaders/lib at the points and directions in the rows of the texture `probe_points`, one pixel a
// point. mail_scenes.probe_source puts the library before it.
void main()
{
    int point = int(gl_FragCoord.x);
    vec3 pos_texture = texelFetch(probe_points, ivec2(point, 0), 0).xyz;
    vec3 dir_metric = texelFetch(probe_points, ivec2(point, 1), 0).xyz;
    Tile tile = tile_of(params);
    probe_result = vec4(lookup_gdm(tile, pos_texture, normalize(dir_metric)), lookup_sdf(tile, pos_texture), 0.0, 1.0);
}
