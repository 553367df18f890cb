#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
#declare G = function(n) { sum(i, 1, n, i * i) + prod(j, 1, 3, j) } F(G(4))
#debug "END\n"
sphere { 0, 1 }
