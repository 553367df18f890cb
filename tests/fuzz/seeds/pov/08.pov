#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
F(exp(1)) F(ln(10)) F(log(1000)) F(pow(2, .5)) F(sqrt(2)) F(degrees(1)) F(radians(90))
#debug "END\n"
sphere { 0, 1 }
