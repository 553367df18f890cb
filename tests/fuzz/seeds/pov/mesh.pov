camera { location <0, 1, -5> look_at 0 angle 40 }
mesh2 { vertex_vectors { 3, <0,0,0>, <1,0,0>, <0,1,0> } face_indices { 1, <0,1,2> } pigment { rgb <1,0,0> } rotate y*30 }
union { sphere { 0, 1 } triangle { 0, x, y } texture { pigment { checker rgb 1 rgb 0 } } }
