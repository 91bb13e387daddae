module edge_moment
  !! Moment m per length of the start along an edge of a shell; it follows the edge. With the parameter c across the edge,
  !! l along it, a_3 the normal and nu the outward conormal of now, the moment does work on the turning of the normal
  !! towards nu, d theta = d a_3 . nu = - a_3 . d x_,nu. With N = a_1 x a_2, j = |N|, s = 1 on the sides c = 1, else -1:
  !!
  !!   f_a  = m s N/j^2 h_a l_0,    h_a = p R_a,c - q R_a,l,    p = |a_l|,   q = a_c . a_l / p
  !!   K_ab = m s l_0 { (dN_b/j^2 - 2 N (N . dN_b)/j^4) h_a + N/j^2 (dp_b R_a,c - dq_b R_a,l) }
  !!
  !! A positive moment bends towards tension at the top, the side of a_3. As everywhere f is an internal force, minus the
  !! load. The tangent is unsymmetric, all its blocks are filled.
  use kinds, only: wp
  use status_codes, only: ok, singular_map
  implicit none (type, external)
  private
  public :: edge_moment_force

contains

  pure subroutine edge_moment_force(side, xe, ue, dshp, length, moment, fe, ke, status)
    integer, intent(in) :: side             !! of the element, 1 to 4
    real(wp), intent(in) :: xe(:,:)         !! reference control points of the element (3,nen) [length]
    real(wp), intent(in) :: ue(:,:)         !! displacements (3,nen) [length]
    real(wp), intent(in) :: dshp(:,:,:)     !! R_,1 and R_,2 at points of the edge (2,nen,ng)
    real(wp), intent(in) :: length(:)       !! lengths of the points at the start (ng) [length]
    real(wp), intent(in) :: moment          !! m [force]
    real(wp), intent(out) :: fe(:,:)        !! minus the load (3,nen) [force]
    real(wp), intent(out) :: ke(:,:,:,:)    !! df/du (3,nen,3,nen), unsymmetric, all blocks
    integer, intent(out) :: status          !! ok, singular_map
    real(wp) :: a(3,2), n(3), dn(3,3), jj, p, q, s, h(size(xe, 2)), dp(3), dq(3), row(3), e(3)
    integer :: b, c, g, i, k, l, node

    fe = 0
    ke = 0
    status = ok
    c = (side + 1)/2
    l = 3 - c
    s = merge(moment, -moment, mod(side, 2) == 0)
    do g = 1, size(length)
      a = matmul(xe + ue, transpose(dshp(:,:,g)))
      n = cross(a(:,1), a(:,2))
      jj = dot_product(n, n)
      p = norm2(a(:,l))
      if (.not. (jj > 0 .and. p > 0)) then
        status = singular_map
        return
      end if
      q = dot_product(a(:,c), a(:,l))/p
      h = p*dshp(c,:,g) - q*dshp(l,:,g)
      do node = 1, size(h)
        fe(:,node) = fe(:,node) + s*length(g)/jj*h(node)*n
      end do
      do b = 1, size(h)
        dp = a(:,l)*dshp(l,b,g)/p
        dq = (a(:,l)*dshp(c,b,g) + a(:,c)*dshp(l,b,g))/p - q/p*dp
        do k = 1, 3
          e = 0
          e(k) = 1
          dn(:,k) = cross(e, a(:,2))*dshp(1,b,g) + cross(a(:,1), e)*dshp(2,b,g)
          row(k) = dot_product(n, dn(:,k))
        end do
        do k = 1, 3
          do node = 1, size(h)
            do i = 1, 3
              ke(i,node,k,b) = ke(i,node,k,b) + s*length(g)/jj*((dn(i,k) - 2*n(i)*row(k)/jj)*h(node) &
                + n(i)*(dp(k)*dshp(c,node,g) - dq(k)*dshp(l,node,g)))
            end do
          end do
        end do
      end do
    end do
  end subroutine edge_moment_force

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)      !! vectors
    real(wp) :: c(3)                        !! a x b

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module edge_moment
