"""Tables typed in from papers and catalogues, because colour-science holds none of them."""
