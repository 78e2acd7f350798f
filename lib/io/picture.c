typedef int ph_i_empty;
